// Blows on modes against the integration of their equation of motion.
#include "engine/modal/fracture/modal_state.h"

#include "engine/base/rotation.h"
#include "tests/modal/fracture/runge_kutta.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace ringdown::modal {
namespace {

constexpr double kImpulse = 0.37, kContact_s = 1e-4;

MassProperties brick() {
  return {.mass_kg = 2, .center_of_mass_m = {0.1, 0.2, 0.3}, .inertia_kg_m2 = {0.02, 0.03, 0.04}};
}

// Free and damped: q'' + 2 d q' + (omega^2 + d^2) q = b s(t), s a half sine that begins at 0.
ModeMotion integrated(const DampedMode& mode, ModeMotion start, double from_s, double to_s) {
  const double lambda = undamped_lambda(mode);
  const auto force = [](double t) {
    if (t < 0 || t > kContact_s) return 0.0;
    return kImpulse * std::numbers::pi / (2 * kContact_s) * std::sin(std::numbers::pi * t / kContact_s);
  };
  const auto [q, v] =
      test::runge_kutta(std::array<double, 2>{start.coordinate, start.velocity}, from_s, to_s, 20000,
                        [&](double t, const std::array<double, 2>& x) {
                          return std::array<double, 2>{x[1], force(t) - 2 * mode.decay_per_s * x[1] - lambda * x[0]};
                        });
  return {q, v};
}

// From far below the pulse's own frequency 1 / (2 tau) = 5 kHz to far above, on it and beside it.
const std::vector<double> kFrequencies_hz = {3,    200,  3000,  4999.99999, 4999.9999999999, 5000, 5000.000001,
                                             5001, 9000, 15000, 60000};

void expect_equal(const DampedMode& mode, const ModeMotion& found, const ModeMotion& truth, double tolerance) {
  const double omega = std::sqrt(undamped_lambda(mode));
  EXPECT_NEAR(omega * found.coordinate, omega * truth.coordinate, tolerance * kImpulse) << mode.frequency_hz;
  EXPECT_NEAR(found.velocity, truth.velocity, tolerance * kImpulse) << mode.frequency_hz;
}

TEST(ModalStates, TheStateInABlowIsThatOfTheEquationOfMotion) {
  for (const double decay : {0.0, 5.0, 800.0, 30000.0}) {
    for (const double frequency : kFrequencies_hz) {
      for (const double share : {0.03, 0.5, 0.77, 1.0}) {
        const DampedMode mode{frequency, decay};
        ModalState state = at_rest({mode}, brick());
        const std::vector<double> given = {kImpulse};
        const Blow blow{.modal_impulse = given, .contact_time_s = kContact_s};
        state.amplitudes[0] = amplitude_of(mode, {1e-6, 0.02});
        advance(state, share * kContact_s);
        add_begun_blow(state, blow, share * kContact_s);
        const ModeMotion truth = integrated(mode, {1e-6, 0.02}, 0, share * kContact_s);
        expect_equal(mode, motion_of(mode, state.amplitudes[0]), truth, 1e-9);
      }
    }
  }
}

TEST(ModalStates, TheRestOfABlowLeavesTheStateThatTheForceLeaves) {
  for (const double decay : {0.0, 800.0}) {
    for (const double frequency : kFrequencies_hz) {
      const DampedMode mode{frequency, decay};
      ModalState state = at_rest({mode}, brick());
      const std::vector<double> given = {kImpulse};
      const Blow blow{.modal_impulse = given, .contact_time_s = kContact_s};
      add_rest_of_blow(state, blow, kContact_s / 2);
      advance(state, kContact_s / 2);
      const ModeMotion truth = integrated(mode, {0, 0}, kContact_s / 2, kContact_s);
      expect_equal(mode, motion_of(mode, state.amplitudes[0]), truth, 1e-9);
    }
  }
}

// Section by the peak of the force, without damping: q = A / (omega^2 - W^2) (sin W t - W / omega sin omega t).
TEST(ModalStates, AtThePeakOfTheForceTheClosedFormHolds) {
  const double w = std::numbers::pi / kContact_s, t = kContact_s / 2, a = kImpulse * w / 2;
  for (const double frequency : {200.0, 3000.0, 9000.0, 15000.0}) {
    const DampedMode mode{frequency, 0};
    const double omega = 2 * std::numbers::pi * frequency;
    ModalState state = at_rest({mode}, brick());
    const std::vector<double> given = {kImpulse};
    add_begun_blow(state, {.modal_impulse = given, .contact_time_s = kContact_s}, t);
    const double factor = a / (omega * omega - w * w);
    const ModeMotion truth{factor * (std::sin(w * t) - w / omega * std::sin(omega * t)),
                           factor * w * (std::cos(w * t) - std::cos(omega * t))};
    expect_equal(mode, motion_of(mode, state.amplitudes[0]), truth, 1e-12);
  }
}

TEST(ModalStates, AWholeBlowIsBothOfItsPartsAndTheMixersStrike) {
  const std::vector<DampedMode> modes = {{300, 0}, {5000, 0}, {12345, 0}};
  const std::vector<double> given = {0.3, -0.2, 0.1};
  const Blow blow{given, {0.3, 0.2, 0.3}, {0.01, 0.02, -0.03}, kContact_s};
  ModalState whole = at_rest(modes, brick()), parts = whole;
  add_blow(whole, blow);
  advance(whole, kContact_s / 2);
  add_begun_blow(parts, blow, 0.3 * kContact_s);
  add_rest_of_blow(parts, blow, 0.3 * kContact_s);
  advance(parts, 0.7 * kContact_s);
  for (std::size_t j = 0; j < modes.size(); ++j)
    EXPECT_LT(std::abs(whole.amplitudes[j] - parts.amplitudes[j]), 1e-12 * std::abs(given[j]) / 1000);
  EXPECT_LT(length(whole.velocity_m_s - parts.velocity_m_s), 1e-15);
  EXPECT_LT(length(whole.spin_rad_s - parts.spin_rad_s), 1e-15);
  EXPECT_LT(length(2.0 * whole.velocity_m_s - blow.impulse_ns), 1e-15);  // of 2 kg
  // The moment about the centre is (0.2, 0, 0) x (0.01, 0.02, -0.03) = (0, 0.006, 0.004).
  EXPECT_LT(length(whole.spin_rad_s - Vec3{0, 0.2, 0.1}), 1e-14);
}

TEST(ModalStates, AnIdealImpulseIsAVelocity) {
  const std::vector<double> given = {0.3};
  ModalState state = at_rest({{400, 7}}, brick());
  add_begun_blow(state, {.modal_impulse = given}, 0);
  add_rest_of_blow(state, {.modal_impulse = given}, 0);
  const ModeMotion motion = motion_of(state.modes[0], state.amplitudes[0]);
  EXPECT_NEAR(motion.coordinate, 0, 1e-18);
  EXPECT_NEAR(motion.velocity, 0.3, 1e-15);
  EXPECT_NEAR(modal_energy(state).total_j(), 0.045, 1e-16);
}

TEST(ModalStates, AnOverdampedModeStaysAtRest) {
  const std::vector<double> given = {0.3, 0.2};
  ModalState state = at_rest({{0, 900}, {100, 1}}, brick());
  add_blow(state, {.modal_impulse = given});
  advance(state, 1e-3);
  EXPECT_EQ(state.amplitudes[0], 0.0);
  EXPECT_EQ(amplitude_of(state.modes[0], {1, 1}), 0.0);
  EXPECT_GT(std::abs(state.amplitudes[1]), 0.0);
}

TEST(ModalStates, MotionAndAmplitudeAreInverse) {
  const DampedMode mode{123, 45};
  const ModeMotion motion = motion_of(mode, amplitude_of(mode, {0.2, -0.7}));
  EXPECT_NEAR(motion.coordinate, 0.2, 1e-15);
  EXPECT_NEAR(motion.velocity, -0.7, 1e-13);
}

TEST(ModalStates, EnergyFallsByWhatDampingTakes) {
  const DampedMode mode{500, 20};
  ModalState state = at_rest({mode}, brick());
  state.amplitudes[0] = amplitude_of(mode, {1e-4, 0.1});
  const double before = modal_energy(state).total_j();
  double lost = 0;  // integral of 2 d q'^2, by the midpoint rule
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    ModalState then = state;
    advance(then, 0.05 * (i + 0.5) / kSteps);
    const double velocity = motion_of(mode, then.amplitudes[0]).velocity;
    lost += 2 * mode.decay_per_s * velocity * velocity * 0.05 / kSteps;
  }
  advance(state, 0.05);
  EXPECT_NEAR(before - modal_energy(state).total_j(), lost, 1e-6 * before);
}

TEST(ModalStates, RigidEnergyIsThatOfTurnedAxes) {
  MassProperties mass = brick();
  const Rotation turn = normalized(Rotation::from_xyzw(0.1, -0.4, 0.3, 0.8));
  mass.orientation = {turn.x, turn.y, turn.z, turn.w};
  const Vec3 spin = rotated(turn, {1, 2, 3});  // in principal axes 1 2 3
  EXPECT_NEAR(rigid_energy_j(mass, {1, 0, 2}, spin), 0.5 * (2 * 5 + 0.02 + 4 * 0.03 + 9 * 0.04), 1e-14);
}

}  // namespace
}  // namespace ringdown::modal
