#include "engine/fit/esprit.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <algorithm>

namespace ringdown::fit {
namespace {

// Sum over all windows w of w w^H. Each element is the one before it on its diagonal, less the product that leaves the
// sum and plus the one that comes in.
Eigen::MatrixXcd covariance(const Eigen::VectorXcd& signal, Eigen::Index length) {
  const Eigen::Index windows = signal.size() - length + 1;
  Eigen::MatrixXcd sum(length, length);
  for (Eigen::Index j = 0; j < length; ++j) {
    sum(0, j) = signal.segment(j, windows).dot(signal.head(windows));
    for (Eigen::Index i = 1; i + j < length; ++i) {
      sum(i, i + j) = sum(i - 1, i + j - 1) - signal[i - 1] * std::conj(signal[i + j - 1]) +
                      signal[i - 1 + windows] * std::conj(signal[i + j - 1 + windows]);
    }
  }
  sum.triangularView<Eigen::StrictlyLower>() = sum.adjoint();
  return sum;
}

// Of noise alone the largest eigenvalue is some (1 + sqrt(L/K))^2 = 2.9 times the mean one [Marchenko & Pastur 1967]; a
// term that refine() would keep makes one of 13 times the noise's.
constexpr double kOverNoise = 4.5;

// A few steps of the power method, where most bands of most recordings end.
bool is_noise(const Eigen::MatrixXcd& sum) {
  constexpr int kSteps = 12;
  const double mean = sum.trace().real() / static_cast<double>(sum.rows());
  Eigen::VectorXcd direction = sum.col(sum.cols() / 2), next;
  for (int step = 0; step < kSteps; ++step) {
    direction.normalize();
    next.noalias() = sum * direction;
    if (next.norm() > kOverNoise * mean) return false;
    direction = next;
  }
  return true;
}

Eigen::Index signal_directions(const Eigen::VectorXd& ascending, Eigen::Index most) {
  constexpr double kOverRounding = 1e-13;
  const double largest = ascending[ascending.size() - 1];
  const double threshold = std::max(kOverNoise * ascending[ascending.size() / 2], kOverRounding * largest);
  const auto above = std::count_if(ascending.begin(), ascending.end(), [&](double value) { return value > threshold; });
  return std::min<Eigen::Index>(above, most);
}

}  // namespace

std::vector<std::complex<double>> find_poles(const Eigen::VectorXcd& signal, Eigen::Index most) {
  if (signal.size() < kMinSamples) return {};
  const Eigen::Index length = signal.size() / 3;
  const Eigen::MatrixXcd sum = covariance(signal, length);
  if (is_noise(sum)) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(sum);
  if (solver.info() != Eigen::Success) return {};
  const Eigen::Index count = signal_directions(solver.eigenvalues(), std::min(most, length / 2));
  if (count == 0) return {};
  const Eigen::MatrixXcd space = solver.eigenvectors().rightCols(count);
  const Eigen::MatrixXcd shift =
      space.topRows(length - 1).colPivHouseholderQr().solve(space.bottomRows(length - 1)).eval();
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> poles(shift, false);
  if (poles.info() != Eigen::Success) return {};
  std::vector<std::complex<double>> logarithms;
  for (const std::complex<double> pole : poles.eigenvalues()) {
    if (std::abs(pole) > 1e-6) logarithms.push_back(std::log(pole));
  }
  return logarithms;
}

}  // namespace ringdown::fit
