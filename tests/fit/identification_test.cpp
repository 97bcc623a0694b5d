// Figures of a body from frequencies alone: a body whose frequencies are formulas, with noise of which everything is
// known.
#include "engine/fit/identification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace ringdown::fit {
namespace {

constexpr std::size_t kModes = 24;
constexpr double kCents = 1731.2340490667561;  // in a neper

// Frequencies that follow E/rho, and two figures p and q by powers that differ from mode to mode.
struct Body {
  double stiffness, p, q;
  [[nodiscard]] std::vector<double> frequencies() const {
    std::vector<double> hz;
    for (std::size_t m = 0; m < kModes; ++m) {
      const auto k = static_cast<double>(m);
      hz.push_back(1000 * (1 + 0.31 * k) * std::sqrt(stiffness) * std::pow(p, 0.5 * std::sin(1.3 * k)) *
                   std::pow(q, 0.3 * std::cos(0.7 * k)));
    }
    return hz;
  }
};

// The changes from one body to the frequencies of another, by repeated linear steps with slopes from differences.
Result<Determined> identify(const std::vector<double>& heard, Body& body) {
  Result<Determined> found = Determined{};
  for (int round = 0; round < 5; ++round) {
    Slopes slopes{body.frequencies(), {}};
    for (double Body::*figure : {&Body::p, &Body::q}) {
      Body further = body;
      further.*figure += 1e-4;
      std::vector<double> slope;
      const std::vector<double> moved = further.frequencies();
      for (std::size_t m = 0; m < kModes; ++m) slope.push_back(std::log(moved[m] / slopes.frequency_hz[m]) / 1e-4);
      slopes.slopes.push_back(slope);
    }
    found = determine(heard, slopes, {.tolerance_cents = 150});
    if (!found) return found;
    body.stiffness *= std::exp(found->changes[0]);
    body.p += found->changes[1];
    body.q += found->changes[2];
  }
  return found;
}

TEST(Determine, ExactFrequenciesGiveTheFiguresBack) {
  Body body{1, 1, 1};
  const auto found = identify(Body{1.03, 0.97, 1.04}.frequencies(), body);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->matches, kModes);
  EXPECT_NEAR(body.stiffness, 1.03, 1e-6);
  EXPECT_NEAR(body.p, 0.97, 1e-6);
  EXPECT_NEAR(body.q, 1.04, 1e-6);
  EXPECT_LT(found->spread_cents, 1e-3);
}

// The oracle is the scatter of five hundred measurements: standard errors and correlations are theirs.
TEST(Determine, ErrorsAndCorrelationsAreThoseOfRepeatedMeasurements) {
  constexpr int kRuns = 500;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 3 / kCents);
  std::array<double, 3> sum{}, stated{};
  std::array<std::array<double, 3>, 3> product{}, correlation{};
  double spread = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> heard = Body{1.01, 0.99, 1.02}.frequencies();
    for (double& hz : heard) hz *= std::exp(noise(random));
    Body body{1, 1, 1};
    const auto found = identify(heard, body);
    ASSERT_TRUE(found);
    const std::array<double, 3> values{std::log(body.stiffness / 1.01), body.p - 0.99, body.q - 1.02};
    for (std::size_t a = 0; a < 3; ++a) {
      sum[a] += values[a] / kRuns;
      stated[a] += found->errors[a] / kRuns;
      for (std::size_t b = 0; b < 3; ++b) {
        product[a][b] += values[a] * values[b] / kRuns;
        correlation[a][b] += found->correlation(a, b) / kRuns;
      }
    }
    spread += found->spread_cents / kRuns;
  }
  EXPECT_NEAR(spread, 3, 0.1);
  for (std::size_t a = 0; a < 3; ++a) {
    const double scatter = std::sqrt(product[a][a]);
    EXPECT_NEAR(stated[a] / scatter, 1, 0.1) << a;
    EXPECT_LT(std::abs(sum[a]), 0.2 * scatter) << a;
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_NEAR(correlation[a][b], product[a][b] / std::sqrt(product[a][a] * product[b][b]), 0.1) << a << b;
  }
}

TEST(Determine, FiguresThatNothingTellsApartAreRefused) {
  const std::vector<double> hz = Body{1, 1, 1}.frequencies();
  const std::vector<double> same(kModes, 0.5), none(kModes, 0.0);
  EXPECT_FALSE(determine(hz, {hz, {same}}, {}));  // moves all frequencies as E/rho does
  EXPECT_FALSE(determine(hz, {hz, {none}}, {}));
  EXPECT_FALSE(determine(std::span(hz).first(2), {hz, {}}, {}));
  EXPECT_TRUE(determine(std::span(hz).first(3), {hz, {}}, {}));
}

}  // namespace
}  // namespace ringdown::fit
