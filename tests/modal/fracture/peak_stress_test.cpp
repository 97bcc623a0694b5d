// The criterion of strength against a search without tables of coordinates.
#include "engine/modal/fracture/peak_stress.h"
#include "tests/modal/fracture/runge_kutta.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <chrono>
#include <numbers>
#include <random>
#include <vector>

namespace ringdown::modal {
namespace {

struct Struck {
  StressTable table;
  ModalState state;
  std::vector<double> impulse;
  Blow blow;
};

Struck struck_body(std::size_t modes, std::size_t points, double contact_time_s, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> number;
  std::vector<DampedMode> all;
  for (std::size_t j = 0; j < modes; ++j)
    all.push_back(
        {150.0 * std::pow(1.4, static_cast<double>(j % 14)) + static_cast<double>(j), 5.0 + static_cast<double>(j)});
  Struck struck{.state = at_rest(all, {.mass_kg = 1, .inertia_kg_m2 = {1, 1, 1}})};
  for (std::size_t j = 0; j < modes; ++j) {
    const double omega = hz_to_rad_per_s(all[j].frequency_hz);
    struck.state.amplitudes[j] = {0.2 * number(random) / omega, 0.2 * number(random) / omega};
    struck.impulse.push_back(number(random));
  }
  struck.table.largest.assign(modes, 0);
  for (std::size_t p = 0; p < points; ++p) {
    struck.table.positions.push_back({static_cast<float>(number(random)), static_cast<float>(number(random)), 0});
    std::vector<float> rows(3 * modes);
    for (std::size_t j = 0; j < modes; ++j) {
      for (std::size_t c = 0; c < 3; ++c)
        rows[c * modes + j] = static_cast<float>(1e9 * number(random) * all[j].frequency_hz);
      const double a = static_cast<double>(rows[j]), b = static_cast<double>(rows[modes + j]),
                   c = static_cast<double>(rows[2 * modes + j]);
      const double size = std::abs(a + b) / 2 + std::sqrt((a - b) * (a - b) / 4 + c * c);
      struck.table.largest[j] = std::max(struck.table.largest[j], static_cast<float>(size));
    }
    struck.table.stress.insert(struck.table.stress.end(), rows.begin(), rows.end());
  }
  struck.blow = {.contact_time_s = contact_time_s};
  return struck;
}

// Coordinates `time_s` after the present by integration of each mode's equation.
std::vector<double> coordinates_at(const Struck& struck, bool blown, double time_s) {
  std::vector<double> found;
  for (std::size_t j = 0; j < struck.state.modes.size(); ++j) {
    const DampedMode& mode = struck.state.modes[j];
    const double lambda = undamped_lambda(mode), tau = struck.blow.contact_time_s;
    const ModeMotion start = motion_of(mode, struck.state.amplitudes[j]);
    const auto slope = [&](double t, const std::array<double, 2>& x) {
      const double force = blown && t < tau
                               ? struck.impulse[j] * std::numbers::pi / (2 * tau) * std::sin(std::numbers::pi * t / tau)
                               : 0;
      return std::array<double, 2>{x[1], force - 2 * mode.decay_per_s * x[1] - lambda * x[0]};
    };
    std::array<double, 2> x = {start.coordinate, start.velocity};
    x = test::runge_kutta(x, 0, std::min(time_s, tau), 200, slope);
    if (time_s > tau) x = test::runge_kutta(x, tau, time_s, 4000, slope);
    found.push_back(x[0]);
  }
  return found;
}

// The largest eigenvalue of a symmetric 2 x 2 matrix, by turning it in small steps.
double tension(double s11, double s22, double s12) {
  double largest = -1e300;
  for (int i = 0; i < 3600; ++i) {
    const double c = std::cos(std::numbers::pi * i / 3600), s = std::sin(std::numbers::pi * i / 3600);
    largest = std::max(largest, c * c * s11 + s * s * s22 + 2 * c * s * s12);
  }
  return largest;
}

TEST(PeakStresses, TheSearchFindsWhatBruteForceFinds) {
  for (const bool blown : {false, true}) {
    Struck struck = struck_body(12, 15, blown ? 2e-4 : 0, 1);
    struck.blow.modal_impulse = struck.impulse;
    const Blow* blow = blown ? &struck.blow : nullptr;
    const StressSearch search{
        .instants_during = 5, .instants_after = 14, .after_s = 2e-3, .spared_m = {0.3, 0.1, 0}, .spared_radius_m = 0.6};
    std::vector<double> times;
    for (int i = 1; blown && i < 5; ++i) times.push_back(2e-4 * i / 5);
    for (int i = 0; i < 14; ++i) times.push_back(struck.blow.contact_time_s + 2e-3 * i / 13);
    double truth = 0, at = 0;
    std::size_t where = 0, spared = 0;
    for (const double time : times) {
      const std::vector<double> q = coordinates_at(struck, blown, time);
      for (std::size_t p = 0; p < 15; ++p) {
        const Vec3f& place = struck.table.positions[p];
        if (std::hypot(place[0] - 0.3f, place[1] - 0.1f) < 0.6f) {
          ++spared;
          continue;
        }
        std::array<double, 3> s{};
        for (std::size_t c = 0; c < 3; ++c) {
          for (std::size_t j = 0; j < 12; ++j)
            s[c] += static_cast<double>(struck.table.stress[(3 * p + c) * 12 + j]) * q[j];
        }
        const double principal = tension(s[0], s[1], s[2]);
        if (principal > truth) truth = principal, at = time, where = p;
      }
    }
    EXPECT_GT(spared, 0u);
    const PeakStress found = peak_stress(struck.table, struck.state, blow, search);
    EXPECT_NEAR(found.stress_pa, truth, 1e-5 * truth) << blown;
    EXPECT_EQ(found.point, where);
    EXPECT_NEAR(found.time_s, at, 1e-12);
  }
}

// Soft blows bend stiff modes that do not ring afterwards, hard ones make them ring.
TEST(PeakStresses, TheBoundIsNeverBelowTheSearch) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Struck struck = struck_body(1 + seed % 20, 30, seed % 4 == 0 ? 0 : 1e-5 * std::pow(1.2, seed), seed);
    struck.blow.modal_impulse = struck.impulse;
    if (seed % 2 == 0) {
      for (auto& a : struck.state.amplitudes) a = 0;
    }
    const double bound = stress_bound_pa(struck.table, struck.state, &struck.blow);
    const double found =
        peak_stress(struck.table, struck.state, &struck.blow, {.instants_during = 60, .instants_after = 60}).stress_pa;
    EXPECT_LE(found, bound * (1 + 1e-6)) << seed;
    EXPECT_GT(found, 0.02 * bound) << seed;
    EXPECT_LE(peak_stress(struck.table, struck.state, nullptr).stress_pa,
              stress_bound_pa(struck.table, struck.state, nullptr) * (1 + 1e-6));
  }
}

TEST(PeakStresses, OneModesBoundIsItsPeak) {
  StressTable table{.positions = {{0, 0, 0}}, .stress = {2e9f, -3e9f, 0}, .largest = {3e9f}};
  ModalState state = at_rest({{1000, 0}}, {.mass_kg = 1, .inertia_kg_m2 = {1, 1, 1}});
  state.amplitudes[0] = std::polar(1e-3, 0.4);
  EXPECT_NEAR(stress_bound_pa(table, state, nullptr), 3e6, 1);
  const PeakStress found = peak_stress(table, state, nullptr, {.instants_after = 2001, .after_s = 1e-3});
  EXPECT_NEAR(found.stress_pa, 3e6, 30);  // when the coordinate is lowest
  EXPECT_NEAR(found.time_s, (std::numbers::pi - 0.4) / (2 * std::numbers::pi * 1000), 1e-6);
}

TEST(PeakStresses, StressesScaleByDimensions) {
  EXPECT_DOUBLE_EQ(stress_factor({.density = 4, .stiffness = 3, .size = 1}), 1.5);
  EXPECT_DOUBLE_EQ(stress_factor({.size = 4}), 1.0 / 32);
}

// Prints a time, and asserts none.
TEST(PeakStresses, CostOfThreeHundredPoints) {
  Struck struck = struck_body(100, 300, 1e-4, 3);
  struck.blow.modal_impulse = struck.impulse;
  const auto begun = std::chrono::steady_clock::now();
  const PeakStress peak = peak_stress(struck.table, struck.state, &struck.blow);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begun;
  std::printf("300 points x 100 modes x 59 instants: %.2f ms\n", taken.count());
  EXPECT_GT(peak.stress_pa, 0);
}

}  // namespace
}  // namespace ringdown::modal
