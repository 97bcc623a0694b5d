// Poles made as good as the noise allows, and those dropped that noise could have made.
//
// Least squares over poles and amplitudes together (Gauss-Newton), which for white noise is the estimate of maximum
// likelihood: its errors reach the Cramer-Rao bound. The same equations give every number its standard error. A term
// whose amplitude is less than kSignificance of its own standard errors is taken out, and the rest fitted again. [any]
#pragma once

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::fit {

// amplitude exp(pole n), n = 0, 1, ...
struct Term {
  std::complex<double> pole;  // logarithm, per sample
  std::complex<double> amplitude;
  double pole_error = 0;    // standard error of each of the pole's two parts
  double significance = 0;  // amplitude over its standard error
};

inline constexpr double kSignificance = 6;

std::vector<Term> refine(const Eigen::VectorXcd& signal, const std::vector<std::complex<double>>& poles);

}  // namespace ringdown::fit
