// Poles by rational approximation, of functions whose poles are known.
#include "engine/cavity/rational.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

namespace ringdown::cavity::rational_test {
namespace {

using Complex = std::complex<double>;

const Complex kPoles[] = {{1.9, -4e-4}, {15.3, -1.5e-3}, {24, -0.4}};

// Two functions with the three poles and their images, and a smooth part, as far fields have it.
Eigen::MatrixXcd samples(const Eigen::VectorXd& places, double noise) {
  Eigen::MatrixXcd values(places.size(), 2);
  for (Eigen::Index n = 0; n < places.size(); ++n) {
    const double k = places[n];
    for (int f = 0; f < 2; ++f) {
      Complex value = (0.2 + f) * std::polar(1.0, 0.03 * k);
      for (int p = 0; p < 3; ++p) value += (1.0 + f * p) / (kPoles[p] * kPoles[p] - k * k);
      values(n, f) = value * (1 + noise * std::sin(1e4 * k));
    }
  }
  return values;
}

Eigen::VectorXd places(double low, double high, int count) {
  Eigen::VectorXd at(count);
  for (int n = 0; n < count; ++n) at[n] = low * std::pow(high / low, n / (count - 1.0));
  return at;
}

double nearest(const std::vector<Pole>& poles, Complex wanted) {
  double distance = HUGE_VAL;
  for (const Pole& pole : poles) distance = std::min(distance, std::abs(pole.at - wanted));
  return distance;
}

TEST(RationalPoles, PolesNearTheRealAxisAreFoundFromRealPlaces) {
  const Eigen::VectorXd at = places(1, 30, 20);
  const std::vector<Pole> poles = poles_of(at, samples(at, 0), 1e-9);
  EXPECT_LT(nearest(poles, kPoles[0]), 2e-6);
  EXPECT_LT(nearest(poles, kPoles[1]), 3e-4);
  EXPECT_LT(nearest(poles, kPoles[2]), 0.01);
}

TEST(RationalPoles, PolesStandOutOfNoiseByTheirStrength) {
  const Eigen::VectorXd at = places(1, 30, 20);
  for (const Pole& pole : poles_of(at, samples(at, 1e-7), 1e-5)) {
    if (pole.at.real() < 1 || pole.at.real() > 20 || std::abs(pole.at.imag()) > 0.1 * pole.at.real()) continue;
    if (pole.strength < 1e-4) continue;
    EXPECT_LT(std::min(std::abs(pole.at - kPoles[0]) / 1.9, std::abs(pole.at - kPoles[1]) / 15.3), 1e-3) << pole.at;
  }
}

TEST(RationalPoles, ConstantFunctionHasNone) {
  EXPECT_TRUE(poles_of(places(1, 2, 6), Eigen::MatrixXcd::Constant(6, 2, Complex(1, 1)), 1e-6).empty());
}

}  // namespace
}  // namespace ringdown::cavity::rational_test
