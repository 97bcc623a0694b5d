#include "engine/modal/hearing/contact_pulse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace ringdown::modal {
namespace {

// The Fourier integral of a half-sine of unit area on [-tau/2, tau/2], by Simpson's rule in long double.
double quadrature(double f, double tau) {
  constexpr int kSteps = 4000;
  const long double pi = std::acos(-1.0L), width = static_cast<long double>(tau);
  const auto integrand = [&](int i) {
    const long double t = width * (static_cast<long double>(i) / kSteps - 0.5L);
    return pi / (2 * width) * std::cos(pi * t / width) * std::cos(2 * pi * static_cast<long double>(f) * t);
  };
  long double sum = integrand(0) + integrand(kSteps);
  for (int i = 1; i < kSteps; ++i) sum += integrand(i) * (i % 2 == 1 ? 4 : 2);
  return static_cast<double>(sum * width / kSteps / 3);
}

TEST(ContactPulse, ThePulseIsTheSpectrumOfAHalfSine) {
  for (const double tau : {1e-5, 2e-4, 1e-3, 0.02}) {
    for (double f = 1; f < std::min(20000.0, 20 / tau); f *= 1.37) {
      EXPECT_NEAR(pulse_spectrum(f, tau), quadrature(f, tau), 1e-9) << f << " Hz, " << tau << " s";
    }
  }
}

TEST(ContactPulse, ThePulseIsOneForAnIdealImpulseAndAtFrequencyZero) {
  EXPECT_DOUBLE_EQ(pulse_spectrum(12345, 0), 1);
  EXPECT_DOUBLE_EQ(pulse_spectrum(0, 0.01), 1);
}

TEST(ContactPulse, ThePulsePassesThroughItsRemovablePole) {
  constexpr double kTau = 1e-3, kPole = 500;
  EXPECT_NEAR(pulse_spectrum(kPole, kTau), M_PI / 4, 1e-15);
  for (double offset = 1e-12; offset < 1; offset *= 3) {
    for (const double sign : {-1.0, 1.0}) {
      const double f = kPole * (1 + sign * offset);
      EXPECT_NEAR(pulse_spectrum(f, kTau), quadrature(f, kTau), 1e-11) << offset;
    }
  }
}

TEST(ContactPulse, ThePulseChangesSignInItsSideLobes) {
  EXPECT_NEAR(pulse_spectrum(1500, 1e-3), 0, 1e-15);
  EXPECT_LT(pulse_spectrum(2000, 1e-3), -0.05);
  EXPECT_GT(pulse_spectrum(3000, 1e-3), 0.01);
}

}  // namespace
}  // namespace ringdown::modal
