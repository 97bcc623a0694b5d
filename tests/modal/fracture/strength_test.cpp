#include "engine/modal/fracture/strength.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace ringdown::modal {
namespace {

const Strength kGlass{.strength_pa = 50e6, .weibull_modulus = 6};

// The largest distance between the share of drawn strengths below a stress and Weibull's law (Kolmogorov): below 1.63 /
// n^1/2 in 99 of 100 samples.
TEST(Strength, DrawnStrengthsFollowWeibullsLaw) {
  for (const double area : {1e-4, 1e-3, 0.05}) {
    std::vector<double> drawn;
    constexpr int kBodies = 20000;
    for (int body = 0; body < kBodies; ++body) drawn.push_back(drawn_strength_pa(kGlass, area, 7, body));
    std::sort(drawn.begin(), drawn.end());
    double distance = 0;
    for (int i = 0; i < kBodies; ++i) {
      const double law = 1 - std::exp(-area / 1e-3 * std::pow(drawn[i] / 50e6, 6));
      distance = std::max({distance, std::abs(law - static_cast<double>(i) / kBodies),
                           std::abs(law - static_cast<double>(i + 1) / kBodies)});
    }
    EXPECT_LT(distance, 1.63 / std::sqrt(kBodies)) << area;
  }
}

TEST(Strength, HalfOfAllBodiesAreBelowTheMedian) {
  EXPECT_NEAR(1 - std::exp(-0.05 / 1e-3 * std::pow(median_strength_pa(kGlass, 0.05) / 50e6, 6)), 0.5, 1e-12);
}

TEST(Strength, ABodysStrengthDependsOnSeedAndNumberAlone) {
  std::set<double> all;
  for (int seed = 0; seed < 50; ++seed) {
    for (int body = 0; body < 50; ++body) {
      const double drawn = drawn_strength_pa(kGlass, 1e-3, seed, body);
      EXPECT_EQ(drawn, drawn_strength_pa(kGlass, 1e-3, seed, body));
      all.insert(drawn);
    }
  }
  EXPECT_EQ(all.size(), 2500u);
}

TEST(Strength, NeighbouringBodiesAreIndependent) {
  double sum = 0;
  constexpr int kPairs = 20000;
  for (int body = 0; body < kPairs; ++body) {
    const auto share = [&](int seed, int number) {  // uniform in (-1/2, 1/2)
      return std::exp(-std::pow(drawn_strength_pa(kGlass, 1e-3, seed, number) / 50e6, 6)) - 0.5;
    };
    sum += share(3, body) * share(3, body + 1) + share(3, body) * share(4, body);
  }
  EXPECT_LT(std::abs(sum), 4 * std::sqrt(2.0 * kPairs) / 12);
}

TEST(Strength, CracksInGlassCostWhatTablesSay) {
  EXPECT_NEAR(crack_energy_j_m2(0.77e6, 72e9, 0.23), 7.8, 0.05);
  EXPECT_NEAR(crack_cost_j(54e-4, 8), 0.13, 0.001);  // the pane of 30 pieces: 43 mJ, times 3
}

TEST(Strength, TheFinestLevelThatEnergyPaysForIsTaken) {
  const std::vector<double> areas = {0.001, 0.003, 0.01};
  EXPECT_FALSE(finest_affordable(areas, 10, 0.0299, 3));
  EXPECT_EQ(finest_affordable(areas, 10, 0.0301, 3), 0u);
  EXPECT_EQ(finest_affordable(areas, 10, 0.299, 3), 1u);
  EXPECT_EQ(finest_affordable(areas, 10, 0.301, 3), 2u);
  EXPECT_EQ(finest_affordable(areas, 0, 0), 2u);
  EXPECT_FALSE(finest_affordable({}, 10, 1));
}

}  // namespace
}  // namespace ringdown::modal
