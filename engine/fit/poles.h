// Poles of a sum of damped exponentials in noise: found without initial values, then refined as far as the noise
// allows. [any thread]
//
//   for (const Term& term : refine(signal, find_poles(signal, most))) ...
//
// poles.cpp describes both methods.
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::fit {

inline constexpr Eigen::Index kMinSamples = 24;

// Finds the logarithms of poles, per sample; at most `max`. Finds too many rather than too few: only directions in
// which the signal is no stronger than noise could be are left out, and refine() judges the rest. None when the signal
// has fewer than kMinSamples.
std::vector<std::complex<double>> find_poles(const Eigen::VectorXcd& signal, Eigen::Index max);

// One damped exponential: amplitude exp(pole n), n = 0, 1, ...
struct Term {
  std::complex<double> pole;  // logarithm, per sample
  std::complex<double> amplitude;
  double pole_error = 0;    // standard error of each of the pole's two parts
  double significance = 0;  // amplitude over its standard error
};

inline constexpr double kSignificance = 6;

// The terms of the signal nearest to `poles`. A term whose amplitude is less than kSignificance of its own standard
// errors is dropped: noise could have made it.
std::vector<Term> refine(const Eigen::VectorXcd& signal, const std::vector<std::complex<double>>& poles);

}  // namespace ringdown::fit
