#include "engine/modal/damping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ringdown::modal {
namespace {

double misfit(RayleighDamping damping, const std::vector<LossFactor>& points) {
  double sum = 0;
  for (const LossFactor& point : points) {
    const double omega = 2 * M_PI * point.frequency_hz;
    sum += std::pow((damping.alpha_per_s / omega + damping.beta_s * omega) / point.eta - 1, 2);
  }
  return sum;
}

TEST(LossFactor, TheLossFactorIsTwiceTheDecayOverTheFrequency) {
  const RayleighDamping damping{7, 2e-7};
  const double omega = 2 * M_PI * 440;
  EXPECT_NEAR(loss_factor(damping, 440), 2 * damp(omega * omega, damping).decay_per_s / omega, 1e-15);
}

TEST(LossFactor, TheLossFactorOfRayleighsOwnCurveGivesItsTwoTermsBack) {
  const RayleighDamping truth{12, 3e-7};
  std::vector<LossFactor> points;
  for (const double f : {50.0, 300.0, 2000.0, 9000.0}) points.push_back({f, loss_factor(truth, f)});
  const RayleighDamping fitted = fit_rayleigh(points);
  EXPECT_NEAR(fitted.alpha_per_s / truth.alpha_per_s, 1, 1e-9);
  EXPECT_NEAR(fitted.beta_s / truth.beta_s, 1, 1e-9);
  for (const LossFactor& point : points) EXPECT_NEAR(loss_factor(fitted, point.frequency_hz) / point.eta, 1, 1e-9);
}

TEST(LossFactor, OneLossFactorIsFittedByStiffnessAlone) {
  const std::vector<LossFactor> points = {{1000, 1e-3}, {1000, 1e-3}};
  const RayleighDamping fitted = fit_rayleigh(points);
  EXPECT_EQ(fitted.alpha_per_s, 0);
  EXPECT_NEAR(fitted.beta_s, 1e-3 / (2 * M_PI * 1000), 1e-15);
}

// A curve that falls faster than alpha's, and one that rises faster than beta's, would have one term below zero.
TEST(LossFactor, NeitherDampingTermFallsBelowZero) {
  const std::vector<LossFactor> falling = {{100, 0.1}, {1000, 1e-3}, {10000, 1e-5}},
                                rising = {{100, 1e-5}, {1000, 1e-3}, {10000, 0.1}};
  EXPECT_EQ(fit_rayleigh(falling).beta_s, 0);
  EXPECT_GT(fit_rayleigh(falling).alpha_per_s, 0);
  EXPECT_EQ(fit_rayleigh(rising).alpha_per_s, 0);
  EXPECT_GT(fit_rayleigh(rising).beta_s, 0);
}

// No step in any direction that is allowed makes the fit better.
TEST(LossFactor, NoOtherPairOfDampingTermsFitsBetter) {
  const std::vector<std::vector<LossFactor>> curves = {
      {{250, 0.01}, {500, 0.01}, {1000, 0.01}, {2000, 0.01}, {4000, 0.01}},
      {{100, 0.03}, {400, 0.02}, {3000, 0.04}},
      {{100, 0.1}, {1000, 1e-3}, {10000, 1e-5}},
      {{100, 1e-5}, {1000, 1e-3}, {10000, 0.1}}};
  for (const auto& points : curves) {
    const RayleighDamping best = fit_rayleigh(points);
    const double min = misfit(best, points);
    const double alpha_step = std::max(1e-3 * best.alpha_per_s, 1e-6), beta_step = std::max(1e-3 * best.beta_s, 1e-13);
    for (const double a : {-1.0, 0.0, 1.0}) {
      for (const double b : {-1.0, 0.0, 1.0}) {
        const RayleighDamping other{best.alpha_per_s + a * alpha_step, best.beta_s + b * beta_step};
        if (other.alpha_per_s < 0 || other.beta_s < 0) continue;
        EXPECT_GE(misfit(other, points), min * (1 - 1e-12));
      }
    }
  }
}

}  // namespace
}  // namespace ringdown::modal
