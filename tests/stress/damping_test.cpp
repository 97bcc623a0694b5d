// Modes on both sides of critical damping in one bake: those that ring are exact, the others are counted and dropped.
#include "tests/stress/claims.h"

#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown {
namespace {

constexpr double kTopHz = 40e3;

mesh::TetMesh block() { return test::box_mesh({3, 2, 2}, {0.1, 0.08, 0.06}); }

struct Mode {
  double frequency_hz, decay_per_s;
};

// q'' + 2 d q' + lambda q = 0 with d = (alpha + beta lambda) / 2 rings at sqrt(lambda - d^2) where that is real. Where
// stiffness damping is so strong that d > 1 / beta, pitch falls with lambda and a cycle loses 55 dB or more: such modes
// are not in a bank (modal::highest_lambda_in_band).
std::vector<Mode> ringing(const std::vector<double>& undamped_hz, modal::RayleighDamping damping) {
  std::vector<Mode> modes;
  for (const double hertz : undamped_hz) {
    const double lambda = std::pow(2 * std::numbers::pi * hertz, 2);
    const double decay = (damping.alpha_per_s + damping.beta_s * lambda) / 2;
    if (lambda - decay * decay < 1e-8 * lambda || decay * damping.beta_s > 1) continue;
    const double damped_hz = std::sqrt(lambda - decay * decay) / (2 * std::numbers::pi);
    if (damped_hz < kTopHz) modes.push_back({damped_hz, decay});
  }
  std::sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.frequency_hz < b.frequency_hz; });
  return modes;
}

std::vector<Mode> modes_of(const modal::Bank& bank) {
  std::vector<Mode> modes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) modes.push_back({bank.frequency_hz[m], bank.decay_per_s[m]});
  std::sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) { return a.frequency_hz < b.frequency_hz; });
  return modes;
}

void expect_ringing(const std::string& name, const std::vector<double>& undamped, modal::RayleighDamping damping,
                    int over_damped) {
  modal::Material material = test::kSteel;
  material.damping = damping;
  const auto baked = bake::bake(test::checked(block()), material,
                                {.element = fem::Element::kTet20, .band_low_hz = 0, .band_high_hz = kTopHz}, name);
  ASSERT_TRUE(baked) << baked.error().message;
  const std::vector<Mode> found = modes_of(baked->bank), expected = ringing(undamped, damping);
  ASSERT_EQ(found.size(), expected.size());
  double worst = 0;
  for (std::size_t m = 0; m < found.size(); ++m) {
    worst = std::max({worst, std::abs(found[m].frequency_hz / expected[m].frequency_hz - 1),
                      std::abs(found[m].decay_per_s / expected[m].decay_per_s - 1)});
  }
  test::enter({.name = name,
               .hard = "under-, critically and over-damped in one band",
               .unknowns = baked->report.unknowns,
               .found = static_cast<int>(found.size()),
               .there = static_cast<int>(expected.size()),
               .error = worst,
               .limit = 1e-6,
               .estimate = baked->report.largest_error,
               .outcome = "against closed forms; " + std::to_string(baked->report.over_damped) +
                          " critically or over-damped modes dropped"});
  EXPECT_LT(worst, 1e-6);
  EXPECT_GT(found.size(), 10u);
  EXPECT_EQ(baked->report.over_damped, over_damped);
}

std::vector<double> undamped() {
  return test::baked_frequencies(block(), test::kSteel,
                                 {.element = fem::Element::kTet20, .band_low_hz = 0, .band_high_hz = 1.3 * kTopHz});
}

// alpha = 2 omega makes a mode critical, to a billionth, and those below it over-damped.
TEST(StressDamping, DampingByMassDropsTheCriticalModeAndThoseBelow) {
  const std::vector<double> hertz = undamped();
  ASSERT_GT(hertz.size(), 20u);
  expect_ringing("alpha = 2 omega_5", hertz, {4 * std::numbers::pi * hertz[4] * (1 + 1e-9), 0}, 5);
}

// beta = 1 / omega stops the pitch from rising at lambda = 2 omega^2, and alpha holds the lowest modes.
TEST(StressDamping, DampingByMassAndStiffnessLeavesOnlyWhatRings) {
  const std::vector<double> hertz = undamped();
  ASSERT_GT(hertz.size(), 20u);
  const double omega = 2 * std::numbers::pi * hertz[0];
  expect_ringing("alpha and beta", hertz, {2.04 * omega, 0.4 / omega}, 2);
}

}  // namespace
}  // namespace ringdown
