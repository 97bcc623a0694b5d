#include "engine/modal/damping.h"

#include "engine/modal/material_scale.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::modal {
namespace {

using ringdown::test::bar_bank;

// q'' + 2 d q' + lambda q = 0, q(0) = 0, q'(0) = 1 by the classical fourth-order Runge-Kutta method.
double integrate(double lambda, RayleighDamping damping, double t, int steps) {
  const double c = damping.alpha_per_s + damping.beta_s * lambda, h = t / steps;
  double q = 0, v = 1;
  const auto slope = [&](double x, double y) { return -lambda * x - c * y; };
  for (int i = 0; i < steps; ++i) {
    const double q1 = v, v1 = slope(q, v);
    const double q2 = v + h / 2 * v1, v2 = slope(q + h / 2 * q1, v + h / 2 * v1);
    const double q3 = v + h / 2 * v2, v3 = slope(q + h / 2 * q2, v + h / 2 * v2);
    const double q4 = v + h * v3, v4 = slope(q + h * q3, v + h * v3);
    q += h / 6 * (q1 + 2 * q2 + 2 * q3 + q4);
    v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
  }
  return q;
}

TEST(Damping, ImpulseResponseSolvesTheEquationOfMotion) {
  for (const double alpha : {0.0, 10.0, 199.0, 200.0, 201.0, 1000.0}) {  // critical at 200
    for (const double t : {1e-4, 0.003, 0.02}) {
      EXPECT_NEAR(impulse_response(1e4, {alpha, 0}, t), integrate(1e4, {alpha, 0}, t, 4000), 1e-12) << alpha;
    }
  }
  EXPECT_NEAR(impulse_response(1e4, {1e9, 0}, 1.0), 1e-9, 1e-13) << "hopelessly over-damped, and still exact";
}

// The mode as heard, found again in the samples of the motion itself.
TEST(Damping, PitchAndT60AreThoseOfTheMotion) {
  const RayleighDamping damping{6, 2e-6};
  const double lambda = std::pow(2 * M_PI * 1000, 2);
  ringdown::test::Samples samples(24000);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n] = impulse_response(lambda, damping, static_cast<double>(n) / 48000);
  }
  const auto heard = ringdown::test::fit_damped_sinusoid(samples, 48000);
  const DampedMode mode = damp(lambda, damping);
  EXPECT_NEAR(mode.frequency_hz, heard.frequency_hz, 1e-6);
  EXPECT_NEAR(mode.decay_per_s, heard.decay_per_s, 1e-6);
  EXPECT_NEAR(mode.decay_per_s, 3 + 1e-6 * lambda, 1e-9);
  EXPECT_NEAR(t60_s(mode.decay_per_s), std::log(1000.0) / heard.decay_per_s, 1e-7);
  EXPECT_NEAR(undamped_lambda(mode), lambda, 1e-9 * lambda);
}

TEST(Damping, OverdampedModesHaveNoPitch) {
  EXPECT_EQ(damp(100, {20, 0}).frequency_hz, 0);
  EXPECT_EQ(damp(100, {30, 0}).frequency_hz, 0);
  EXPECT_GT(damp(100, {19.99, 0}).frequency_hz, 0);
}

// Every factor on the bar's material against the bar made of that material.
TEST(Rescale, ARescaledModeIsTheModeOfTheOtherMaterial) {
  const Bank bar = bar_bank(8);
  const Material& m = *bar.material;
  for (const MaterialScale scale : {MaterialScale{2, 1, 1, 1},
                                    {1, 3, 1, 1},
                                    {1, 1, 0.3, 1},
                                    {1, 1, 1, 0.1},
                                    {0, 1, 1, 1},
                                    {1, 0, 1, 1},
                                    {0.5, 4, 2, 3}}) {
    for (std::size_t i = 0; i < bar.mode_count(); ++i) {
      const double lambda = undamped_lambda({bar.frequency_hz[i], bar.decay_per_s[i]});
      const double new_lambda = lambda * scale.stiffness / scale.density;
      const double d = (scale.alpha * m.damping.alpha_per_s + scale.beta * m.damping.beta_s * new_lambda) / 2;
      const DampedMode mode = rescale(bar, i, scale);
      EXPECT_NEAR(mode.decay_per_s, d, 1e-10 * d + 1e-10);
      EXPECT_NEAR(mode.frequency_hz, std::sqrt(new_lambda - d * d) / (2 * M_PI), 1e-9 * mode.frequency_hz);
    }
  }
  EXPECT_NEAR(shape_factor({.density = 4}), 0.5, 1e-15);
}

TEST(Rescale, RescalingByOneIsTheBankBitForBit) {
  const Bank bar = bar_bank(8);
  for (std::size_t i = 0; i < bar.mode_count(); ++i) {
    EXPECT_EQ(rescale(bar, i, {}).frequency_hz, bar.frequency_hz[i]);
    EXPECT_EQ(rescale(bar, i, {}).decay_per_s, bar.decay_per_s[i]);
  }
}

TEST(Rescale, RescalingThereAndBackIsTheSame) {
  const Bank bar = bar_bank(8);
  const MaterialScale there{2, 3, 0.5, 1.7}, back{1 / 2.0, 1 / 3.0, 1 / 0.5, 1 / 1.7};
  Bank other = bar;
  other.material->damping.alpha_per_s *= there.alpha;
  other.material->damping.beta_s *= there.beta;
  for (std::size_t i = 0; i < bar.mode_count(); ++i) {
    const DampedMode mode = rescale(bar, i, there);
    other.frequency_hz[i] = mode.frequency_hz;
    other.decay_per_s[i] = mode.decay_per_s;
  }
  for (std::size_t i = 0; i < bar.mode_count(); ++i) {
    EXPECT_NEAR(rescale(other, i, back).frequency_hz, bar.frequency_hz[i], 1e-9 * bar.frequency_hz[i]);
    EXPECT_NEAR(rescale(other, i, back).decay_per_s, bar.decay_per_s[i], 1e-9 * bar.decay_per_s[i]);
  }
}

}  // namespace
}  // namespace ringdown::modal
