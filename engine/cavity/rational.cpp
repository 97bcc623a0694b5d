#include "engine/cavity/rational.h"

#include "engine/dense/decompositions.h"

#include <algorithm>
#include <cmath>

namespace ringdown::cavity {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// The weights that make the linearised error least: the last singular vector of Loewner's matrix.
VectorXcd weights_for(const VectorXd& places, const MatrixXcd& values, const std::vector<Index>& support,
                      const std::vector<Index>& others) {
  const auto points = static_cast<Index>(support.size()), rows = static_cast<Index>(others.size());
  MatrixXcd loewner(rows * values.cols(), points);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < points; ++j) {
      loewner.block(i * values.cols(), j, values.cols(), 1) =
          (values.row(others[i]) - values.row(support[j])).transpose() / (places[others[i]] - places[support[j]]);
    }
  }
  return dense::hermitian_spectrum(loewner.adjoint() * loewner).vectors.col(0);
}

// The quotient at a place that is no support point.
Eigen::RowVectorXcd quotient(const VectorXd& places, const MatrixXcd& values, const std::vector<Index>& support,
                             const VectorXcd& weights, double z) {
  Eigen::RowVectorXcd above = Eigen::RowVectorXcd::Zero(values.cols());
  Complex below = 0;
  for (std::size_t j = 0; j < support.size(); ++j) {
    const Complex share = weights[static_cast<Index>(j)] / (z - places[support[j]]);
    above += share * values.row(support[j]);
    below += share;
  }
  return above / below;
}

// The zeros of the sum of w_j / (z - z_j). With v_j = 1 / (z - z_j) the sum is w.v, and z v_j = z_j v_j + 1; so z is an
// eigenvalue of the diagonal matrix of z_j minus 1 w^T diag(z_j) / sum of w_j. Its one other eigenvalue is 0, which is
// kept away from the poles by counting places from outside of them.
VectorXcd zeros_of(const VectorXd& places, const std::vector<Index>& support, const VectorXcd& weights) {
  const auto points = static_cast<Index>(support.size());
  const double from = places.minCoeff() - 2 * (places.maxCoeff() - places.minCoeff());
  VectorXcd z(points);
  for (Index j = 0; j < points; ++j) z[j] = places[support[j]] - from;
  MatrixXcd matrix = z.asDiagonal();
  matrix -= VectorXcd::Ones(points) * weights.cwiseProduct(z).transpose() / weights.sum();
  VectorXcd zeros = dense::complex_spectrum(matrix).values;
  std::ranges::sort(zeros, {}, [](const Complex& zero) { return std::abs(zero); });
  return zeros.tail(points - 1).array() + from;
}

}  // namespace

std::vector<Pole> poles_of(const VectorXd& places, const MatrixXcd& values, double tolerance) {
  std::vector<Index> support, others;
  for (Index i = 0; i < places.size(); ++i) others.push_back(i);
  const double limit = tolerance * values.rowwise().norm().maxCoeff();
  MatrixXcd error = values.rowwise() - values.colwise().mean();
  VectorXcd weights;
  while (2 * static_cast<Index>(support.size()) < places.size()) {
    const auto worst = std::ranges::max_element(others, {}, [&](Index i) { return error.row(i).norm(); });
    if (error.row(*worst).norm() <= limit) break;
    support.push_back(*worst);
    others.erase(worst);
    weights = weights_for(places, values, support, others);
    for (const Index i : others) error.row(i) = values.row(i) - quotient(places, values, support, weights, places[i]);
  }
  if (support.size() < 2) return {};
  std::vector<double> lengths;
  for (Index i = 0; i < values.rows(); ++i) lengths.push_back(values.row(i).norm());
  std::ranges::nth_element(lengths, lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2));
  const double median = lengths[lengths.size() / 2];
  std::vector<Pole> poles;
  for (const Complex& zero : zeros_of(places, support, weights)) {
    Eigen::RowVectorXcd above = Eigen::RowVectorXcd::Zero(values.cols());
    Complex slope = 0;
    for (std::size_t j = 0; j < support.size(); ++j) {
      const Complex share = weights[static_cast<Index>(j)] / (zero - places[support[j]]);
      above += share * values.row(support[j]);
      slope -= share / (zero - places[support[j]]);
    }
    poles.push_back({zero, (above / slope).norm() / (std::abs(zero) * median)});
  }
  return poles;
}

}  // namespace ringdown::cavity
