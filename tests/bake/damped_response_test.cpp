// The impulse response of one mode in all three regimes, against the direct forms in long double.
#include "engine/modal/damping.h"

#include <gtest/gtest.h>

namespace ringdown::damped_response_test {
namespace {

using modal::RayleighDamping;

// z'' + 2 d z' + lambda z = 0, z(0) = 0, z'(0) = 1, by the textbook's form for the regime.
long double direct(long double lambda, long double decay, long double t) {
  const long double discriminant = decay * decay - lambda;
  if (discriminant < 0) {
    const long double omega = std::sqrt(-discriminant);
    return std::exp(-decay * t) * std::sin(omega * t) / omega;
  }
  if (discriminant == 0) return t * std::exp(-decay * t);
  const long double root = std::sqrt(discriminant), w1 = -decay + root, w2 = -decay - root;
  return (std::exp(w1 * t) - std::exp(w2 * t)) / (w1 - w2);
}

TEST(ImpulseResponse, TheImpulseResponseFollowsTheDirectFormInEveryRegime) {
  const double lambda = 1e6;  // omega 1000 rad/s: critical at d = 1000 1/s, alpha = 2000
  for (const double decay : {0.0, 1.0, 500.0, 990.0, 1000.0, 1010.0, 3000.0, 20000.0}) {
    for (const double t : {1e-6, 1e-4, 1e-3, 5e-3, 2e-2}) {
      const auto expected = static_cast<double>(direct(lambda, decay, t));
      const double found = modal::impulse_response(lambda, RayleighDamping{.alpha_per_s = 2 * decay}, t);
      EXPECT_NEAR(found, expected, 1e-11 * std::abs(expected) + 1e-16) << "decay " << decay << " t " << t;
    }
  }
}

// The report's form, 2 I g / |Im w| ..., is twice as loud and divides by zero here; the limit is I t exp(-d t).
TEST(ImpulseResponse, TheImpulseResponseIsFiniteAndSmoothThroughCriticalDamping) {
  const double lambda = 1e6, t = 2e-3;
  const double critical = t * std::exp(-2.0);
  for (const double off : {0.0, 1e-14, -1e-14, 1e-9, -1e-9, 1e-6, -1e-6}) {
    const double found = modal::impulse_response(lambda, RayleighDamping{.alpha_per_s = 2000 * (1 + off)}, t);
    EXPECT_NEAR(found, critical, 1e-5 * critical) << off;
  }
}

// A mode damped a million times over creeps back at lambda / (2 d); the direct form in double loses every digit of it.
TEST(ImpulseResponse, TheImpulseResponseKeepsItsDigitsWhenHeavilyOverDamped) {
  const double lambda = 1e4, decay = 1e9, t = 100;
  const double expected = std::exp(-lambda * t / (2 * decay)) / (2 * decay);
  EXPECT_NEAR(modal::impulse_response(lambda, RayleighDamping{.alpha_per_s = 2 * decay}, t), expected, 1e-9 * expected);
}

TEST(ImpulseResponse, TheImpulseResponseStartsWithUnitVelocity) {
  for (const double alpha : {0.0, 2000.0, 1e5}) {
    const double t = 1e-10;
    EXPECT_NEAR(modal::impulse_response(1e6, RayleighDamping{.alpha_per_s = alpha}, t) / t, 1, 1e-4);
  }
}

}  // namespace
}  // namespace ringdown::damped_response_test
