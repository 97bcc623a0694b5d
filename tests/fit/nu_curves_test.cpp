// Modes of one shape with different Poisson's ratios, whose order changes.
#include "engine/fit/nu_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace ringdown::fit {
namespace {

// The squared frequency of a mode at constant E, of parts that bend as a thin plate, shear and compress.
struct Line {
  double bending, shear, compression;  // [Hz^2]
  [[nodiscard]] double at(double nu) const {
    return std::sqrt(bending / (1 - nu * nu) + shear / (1 + nu) + compression * nu / ((1 + nu) * (1 - 2 * nu)));
  }
  [[nodiscard]] double log_slope(double nu) const {
    const double below = (1 + nu) * (1 - 2 * nu);
    const double of_square = 2 * nu * bending / std::pow(1 - nu * nu, 2) - shear / std::pow(1 + nu, 2) +
                             compression * (1 + 2 * nu * nu) / (below * below);
    return 0.5 * of_square / std::pow(at(nu), 2);
  }
};
// Lines that cross between all of the banks' ratios.
constexpr std::array<Line, 4> kLines = {{{1e6, 0, 0}, {0, 1.3225e6, 0}, {0, 0.9216e6, 0.36e6}, {0, 1.5625e6, 0}}};
constexpr std::array<double, 3> kRatios = {0.1, 0.25, 0.4};

// Mode m moves point m most and the next one a little, in a direction that a material changes a little.
modal::Bank bank_at(double nu, std::vector<std::size_t> modes = {0, 1, 2, 3}) {
  modal::Bank bank{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::ranges::rotate(modes, modes.begin() + (nu > 0.2 ? 1 : 0));  // a bank's order is not that of frequencies
  for (const std::size_t m : modes) {
    bank.frequency_hz.push_back(kLines[m].at(nu));
    bank.decay_per_s.push_back(1);
    for (std::size_t p = 0; p < 4; ++p) {
      const float most = p == m ? 3.0F : 0, little = p == (m + 1) % 4 ? static_cast<float>(nu) : 0;
      bank.shapes.push_back({most, little, 0});
    }
  }
  return bank;
}

std::array<modal::Bank, 3> three_banks() { return {bank_at(kRatios[0]), bank_at(kRatios[1]), bank_at(kRatios[2])}; }

NuCurves curves_of(const std::array<modal::Bank, 3>& banks) {
  const std::array<NuBank, 3> choices{NuBank{kRatios[0], banks.data()}, NuBank{kRatios[1], &banks[1]},
                                      NuBank{kRatios[2], &banks[2]}};
  return NuCurves(choices);
}

std::vector<double> truth_at(double nu) {
  std::vector<double> hz;
  for (const Line& line : kLines) hz.push_back(line.at(nu));
  std::ranges::sort(hz);
  return hz;
}

double worst_hz(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return INFINITY;
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

TEST(NuCurves, ModesThatCrossAreFollowedByTheirShapes) {
  auto banks = three_banks();
  for (double nu = 0.1; nu < 0.401; nu += 0.02) EXPECT_LT(worst_hz(curves_of(banks).at(nu), truth_at(nu)), 1e-6) << nu;
  for (modal::Bank& bank : banks) bank.shapes.clear();
  EXPECT_GT(worst_hz(curves_of(banks).at(0.18), truth_at(0.18)), 3) << "by rank alone they are not the lines";
}

TEST(NuCurves, ModesAreFollowedAtThePointsThatBanksShare) {
  auto banks = three_banks();
  modal::Bank& last = banks[2];
  const modal::Bank before = last;
  last.positions.insert(last.positions.begin(), {5, 5, 5});  // another point, where all modes move alike
  last.shapes.clear();
  for (std::size_t m = 0; m < 4; ++m) {
    last.shapes.push_back({9, 9, 9});
    for (std::size_t p = 0; p < 4; ++p) last.shapes.push_back(before.shape(m, p));
  }
  EXPECT_LT(worst_hz(curves_of(banks).at(0.18), truth_at(0.18)), 1e-6);
  last.positions[1] = {0, 0, 2};  // no longer shared
  const auto by_rank = curves_of(banks).at(0.18);
  banks = three_banks();
  banks[2].shapes.clear();
  EXPECT_EQ(by_rank, curves_of(banks).at(0.18)) << "three common points are too few";
}

TEST(NuCurves, AnExactBankMovesEachCurveByItsOwnFactor) {
  const auto banks = three_banks();
  constexpr std::array<double, 4> kFactors = {0.99, 0.97, 1.0, 0.95};
  modal::Bank exact = bank_at(0.2);
  for (std::size_t m = 0; m < 4; ++m) exact.frequency_hz[m] *= kFactors[m];
  std::vector<double> expected;
  for (std::size_t m = 0; m < 4; ++m) expected.push_back(kFactors[m] * kLines[m].at(0.3));
  std::ranges::sort(expected);
  EXPECT_LT(worst_hz(curves_of(banks).through(exact, 0.2).at(0.3), expected), 1e-6);
}

TEST(NuCurves, SlopesAreThoseOfTheModesAtTheirRatio) {
  const auto banks = three_banks();
  const Slopes slopes = curves_of(banks).slopes(0.3);
  ASSERT_EQ(slopes.slopes.size(), 1u);
  ASSERT_LT(worst_hz(slopes.frequency_hz, truth_at(0.3)), 1e-6);
  for (const Line& line : kLines) {
    const auto rank =
        std::ranges::min_element(slopes.frequency_hz, {}, [&](double hz) { return std::abs(hz - line.at(0.3)); }) -
        slopes.frequency_hz.begin();
    EXPECT_NEAR(slopes.slopes[0][static_cast<std::size_t>(rank)], line.log_slope(0.3), 1e-5);
  }
}

TEST(NuCurves, AFurtherBankCorrectsTheCurvesNearItsRatio) {
  constexpr double kFurther = 0.33;
  const auto banks = three_banks();
  modal::Bank further = bank_at(kFurther);
  for (double& hz : further.frequency_hz) hz *= 1.02;  // no mode of a kind that three banks tell
  const std::array<NuBank, 4> choices{NuBank{kRatios[0], banks.data()}, NuBank{kRatios[1], &banks[1]},
                                      NuBank{kFurther, &further}, NuBank{kRatios[2], &banks[2]}};
  const NuCurves curves = NuCurves(choices).around(kFurther, 0.05);
  std::vector<double> expected = truth_at(kFurther);
  for (double& hz : expected) hz *= 1.02;
  EXPECT_LT(worst_hz(curves.at(kFurther), expected), 1e-6);
  EXPECT_LT(worst_hz(curves.at(kRatios[0]), truth_at(kRatios[0])), 1e-6);
  EXPECT_DOUBLE_EQ(curves.lowest(), 0.28);
  EXPECT_DOUBLE_EQ(curves.highest(), 0.38);
}

TEST(NuCurves, AModeThatABankLacksHasNoCurve) {
  auto banks = three_banks();
  banks[2] = bank_at(kRatios[2], {0, 1, 2});
  EXPECT_EQ(curves_of(banks).at(0.3).size(), 3u);
}

}  // namespace
}  // namespace ringdown::fit
