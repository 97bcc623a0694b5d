// Collisions of bodies that bend: Hertz's law for stiff ones, an integration in time for one mode, and conservation.
#include "engine/breaking/collision.h"
#include "engine/breaking/piece_set.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::breaking {
namespace {

constexpr double kMass_kg = 0.3;

// A body of a mass and three moments, about the origin.
struct Body {
  explicit Body(modal::Bank bank) {
    bank.mass.emplace();
    bank.mass->mass_kg = kMass_kg;
    bank.mass->inertia_kg_m2 = {4e-4, 5e-4, 3e-4};
    state = modal::at_rest(modes_of(bank), *bank.mass);
    map = std::make_unique<const modal::StrikeMap>(test::shared(std::move(bank)));
  }
  std::unique_ptr<const modal::StrikeMap> map;
  modal::ModalState state;
};

MeetingPoint below(double closing_m_s, double stiffness, double bounce = 1) {
  return {.point_m = {0, 0, -0.1},
          .normal = {0, 0, 1},
          .closing_m_s = closing_m_s,
          .law = {.stiffness = stiffness, .bounce = bounce}};
}

TEST(Collision, AStiffBodyBouncesAsHertzSays) {
  const Body body(test::single_mode_bank(1000, 1, {0, 0, 0}));
  constexpr double kOther_kg = 0.5, kReduced_kg = kMass_kg * kOther_kg / (kMass_kg + kOther_kg);
  for (const double speed : {0.1, 1.0, 5.0}) {
    for (const double bounce : {1.0, 0.5}) {
      Collision collision(*body.map, {}, body.state,
                          {.points = {below(speed, 1e9, bounce)}, .other_per_kg = {1 / kOther_kg}});
      double lasts_s = 0;
      while (!collision.is_over()) {
        collision.step();
        if (collision.force_n() > 0) lasts_s = collision.time_s();
      }
      EXPECT_NEAR(collision.impulse_ns(), (1 + bounce) * kReduced_kg * speed, 0.05 * kReduced_kg * speed);
      EXPECT_NEAR(collision.state().velocity_m_s.z, collision.impulse_ns() / kMass_kg, 1e-12);
      if (bounce < 1) continue;
      const double depth_m = std::pow(1.25 * kReduced_kg * speed * speed / 1e9, 0.4);
      EXPECT_NEAR(lasts_s, 2.943 * depth_m / speed, 1.5 * collision.step_s());
    }
  }
}

// The oracle integrates the two differential equations by Runge and Kutta's method.
TEST(Collision, AMassOnASpringAgainstAWallAsIntegrated) {
  constexpr double kFrequency_hz = 900, kStiffness = 2e9, kSpeed_m_s = 2;
  constexpr float kShape = 2.5F;
  const Body body(test::single_mode_bank(kFrequency_hz, 1e-3, {0, 0, kShape}));
  Collision collision(*body.map, {}, body.state, {.points = {below(kSpeed_m_s, kStiffness)}, .other_per_kg = {}});
  struct State {
    double depth, closing, q, rate;  // of the rigid motion, and of the mode
  };
  const double omega = 2 * std::numbers::pi * kFrequency_hz, shape = static_cast<double>(kShape);
  const auto slope = [&](const State& s) {
    const double depth = s.depth - shape * s.q, force = depth > 0 ? kStiffness * std::pow(depth, 1.5) : 0;
    return State{s.closing, -force / kMass_kg, s.rate, shape * force - omega * omega * s.q};
  };
  const auto plus = [](const State& s, const State& d, double h) {
    return State{s.depth + h * d.depth, s.closing + h * d.closing, s.q + h * d.q, s.rate + h * d.rate};
  };
  State state{0, kSpeed_m_s, 0, 0};
  while (!collision.is_over()) {
    collision.step();
    constexpr int kSteps = 200;
    const double h = collision.step_s() / kSteps;
    for (int n = 0; n < kSteps; ++n) {
      const State a = slope(state), b = slope(plus(state, a, h / 2)), c = slope(plus(state, b, h / 2)),
                  d = slope(plus(state, c, h));
      state = plus(plus(plus(plus(state, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
    }
    EXPECT_NEAR(collision.state().amplitudes[0].real() * shape, state.q * shape, 2e-6) << "of 0.1 mm";
    EXPECT_NEAR(collision.state().velocity_m_s.z, kSpeed_m_s - state.closing, 0.01 * kSpeed_m_s);
  }
  EXPECT_GT(modal::modal_energy(collision.state()).total_j(), 0.05 * 0.5 * kMass_kg * kSpeed_m_s * kSpeed_m_s);
}

// Another body of 0.4 kg meets a body at rest at three points, one after another.
TEST(Collision, EnergyGoesIntoModesAndMotionAndNowhereElse) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    modal::Bank bank = test::random_bank(seed, 40, 200);
    for (double& decay : bank.decay_per_s) decay = 1e-6;
    const std::vector<modal::Vec3f> places = bank.positions;
    const Body body(std::move(bank));
    constexpr double kOther_kg = 0.4, kSpeed_m_s = 2;
    Meeting meeting{.points = {}, .other_per_kg = std::vector<double>(9, 1 / kOther_kg)};
    for (const std::size_t k : {3u, 40u, 90u}) {
      MeetingPoint point = below(kSpeed_m_s, 1e8);
      point.point_m = 0.1 * Vec3{places[k][0], places[k][1], places[k][2]};
      point.gap_m = 1e-5 * static_cast<double>(k - 3);
      meeting.points.push_back(point);
    }
    Collision collision(*body.map, {}, body.state, meeting);
    while (!collision.is_over()) collision.step();
    const modal::ModalState& after = collision.state();
    EXPECT_NEAR(kMass_kg * after.velocity_m_s.z, collision.impulse_ns(), 1e-9);
    const double other_m_s = kSpeed_m_s - collision.impulse_ns() / kOther_kg;
    const double modes_j = modal::modal_energy(after).total_j();
    const double all_j = modes_j + modal::rigid_energy_j(after.mass, after.velocity_m_s, after.spin_rad_s) +
                         0.5 * kOther_kg * other_m_s * other_m_s;
    const double before_j = 0.5 * kOther_kg * kSpeed_m_s * kSpeed_m_s;
    EXPECT_LE(all_j, before_j * (1 + 1e-9));
    EXPECT_GT(all_j, 0.98 * before_j);
    EXPECT_GT(modes_j, 0.02 * before_j);
  }
}

// Two bodies that differ by a force's history alone have no other way to do so: a body that rings meets the wall sooner
// or later, but a body whose modes do not reach the contact meets it as a stiff one.
TEST(Collision, OnlyMotionAlongTheNormalCounts) {
  const Body across(test::single_mode_bank(700, 1, {3, 0, 0})), stiff(test::single_mode_bank(700, 1, {0, 0, 0}));
  modal::ModalState ringing = across.state;
  ringing.amplitudes[0] = {1e-3, 2e-3};
  Collision one(*across.map, {}, ringing, {.points = {below(1, 1e8)}, .other_per_kg = {}});
  Collision other(*stiff.map, {}, stiff.state, {.points = {below(1, 1e8)}, .other_per_kg = {}});
  for (; !one.is_over(); one.step(), other.step()) EXPECT_EQ(one.force_n(), other.force_n());
  EXPECT_NEAR(std::abs(one.state().amplitudes[0]), std::abs(ringing.amplitudes[0]),
              1e-2 * std::abs(ringing.amplitudes[0]));
}

}  // namespace
}  // namespace ringdown::breaking
