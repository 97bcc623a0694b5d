#include "engine/fit/poles.h"

#include "engine/dense/decompositions.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::fit {

// Finding poles: ESPRIT
//
// Windows of the signal, one third of its length, are vectors in a space of which the exponentials span a small
// subspace. A window one sample later lies in this subspace, too, with each exponential multiplied by its pole.
// Therefore the poles are the eigenvalues of the map between the subspace's basis without its last row and the basis
// without its first row. The basis consists of the eigenvectors of the windows' covariance whose eigenvalues stand
// above the noise; the map is a least-squares solution. Source: Roy & Kailath, IEEE Trans. Acoust. Speech Signal
// Process. 37(7), 1989; damped exponentials: Badeau, Boyer & David, EUSIPCO 2002.
namespace {

// Sum over all windows w of w w^H. Each element is the previous one on its diagonal, minus the product that leaves the
// sum, plus the product that enters.
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

// With noise alone, the largest eigenvalue is about (1 + sqrt(L/K))^2 = 2.9 times the mean one [Marchenko & Pastur
// 1967]. A term that refine() would keep makes an eigenvalue of 13 times the noise's.
constexpr double kOverMedian = 4.5;

// A quick test for noise, by a few steps of the power method. Most bands of most recordings need nothing more.
bool is_noise(const Eigen::MatrixXcd& sum) {
  constexpr int kSteps = 12;
  const double mean = sum.trace().real() / static_cast<double>(sum.rows());
  Eigen::VectorXcd direction = sum.col(sum.cols() / 2), next;
  for (int step = 0; step < kSteps; ++step) {
    direction.normalize();
    next.noalias() = sum * direction;
    if (next.norm() > kOverMedian * mean) return false;
    direction = next;
  }
  return true;
}

Eigen::Index signal_directions(const Eigen::VectorXd& ascending, Eigen::Index max) {
  constexpr double kOverRounding = 1e-13;
  const double largest = ascending[ascending.size() - 1];
  const double threshold = std::max(kOverMedian * ascending[ascending.size() / 2], kOverRounding * largest);
  const auto above = std::count_if(ascending.begin(), ascending.end(), [&](double value) { return value > threshold; });
  return std::min<Eigen::Index>(above, max);
}

}  // namespace

std::vector<std::complex<double>> find_poles(const Eigen::VectorXcd& signal, Eigen::Index max) {
  if (signal.size() < kMinSamples) return {};
  const Eigen::Index length = signal.size() / 3;
  const Eigen::MatrixXcd sum = covariance(signal, length);
  if (is_noise(sum)) return {};
  const dense::HermitianSpectrum directions = dense::hermitian_spectrum(sum);
  if (!directions.values.allFinite()) return {};
  const Eigen::Index count = signal_directions(directions.values, std::min(max, length / 2));
  if (count == 0) return {};
  const Eigen::MatrixXcd space = directions.vectors.rightCols(count);
  const dense::ComplexSpectrum poles =
      dense::complex_spectrum(dense::least_squares(space.topRows(length - 1), space.bottomRows(length - 1)));
  if (!poles.values.allFinite()) return {};
  std::vector<std::complex<double>> logarithms;
  for (const std::complex<double> pole : poles.values) {
    if (std::abs(pole) > 1e-6) logarithms.push_back(std::log(pole));
  }
  return logarithms;
}

// Refining poles: least squares
//
// Gauss-Newton steps fit poles and amplitudes together. For white noise this is the maximum-likelihood estimate, whose
// errors reach the Cramer-Rao bound. The normal equations of a step also give the standard error of every number. Terms
// whose amplitude does not stand above its standard error are removed, the weakest first, and the rest is fitted again
// until all remaining terms are significant.
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

constexpr int kMaxSteps = 12;
constexpr double kRidge = 1e-13;

// One column for each pole: exp(pole n), in runs that begin with an exact power.
MatrixXcd exponentials(const VectorXcd& poles, Index samples) {
  constexpr Index kRun = 32;
  MatrixXcd columns(samples, poles.size());
  for (Index k = 0; k < poles.size(); ++k) {
    const Complex ratio = std::exp(poles[k]);
    auto column = columns.col(k);
    column[0] = 1;
    for (Index n = 1; n < std::min(kRun, samples); ++n) column[n] = column[n - 1] * ratio;
    for (Index first = kRun; first < samples; first += kRun) {
      const Index size = std::min(kRun, samples - first);
      column.segment(first, size) = std::exp(poles[k] * static_cast<double>(first)) * column.head(size);
    }
  }
  return columns;
}

// Sums over n = 0 ... count - 1 of n^k ratio^n, for k = 0, 1, 2. `end` is ratio^count. The first is a geometric sum,
// and each of the others is the derivative of the previous one by the logarithm of the ratio. The closed forms lose
// digits where the ratio is near 1.
std::array<Complex, 3> power_sums(Complex ratio, Complex end, double count) {
  const Complex below = ratio - 1.0, plain = (end - 1.0) / below;
  const Complex first = (count * end - plain * ratio) / below;
  return {plain, first, (count * count * end - (plain + 2.0 * first) * ratio) / below};
}

// The lower triangle of columns^H columns, and with `slopes` that of [columns, n columns]^H [columns, n columns]. Only
// the few pairs of poles that nearly coincide are summed over the samples.
MatrixXcd products(const VectorXcd& poles, const MatrixXcd& columns, bool slopes) {
  constexpr double kNear = 4;  // distance of two poles, times the number of samples
  const Index count = poles.size(), size = slopes ? 2 * count : count;
  const auto samples = static_cast<double>(columns.rows());
  const Eigen::VectorXd n = Eigen::VectorXd::LinSpaced(columns.rows(), 0, samples - 1);
  const VectorXcd ratios = poles.array().exp(), ends = (samples * poles).array().exp();
  MatrixXcd gram = MatrixXcd::Zero(size, size);
  for (Index j = 0; j < count; ++j) {
    for (Index i = j; i < count; ++i) {
      const Complex ratio = std::conj(ratios[i]) * ratios[j];
      std::array<Complex, 3> sums;
      if (std::norm(ratio - 1.0) * samples * samples < kNear * kNear) {
        const VectorXcd terms = columns.col(i).conjugate().cwiseProduct(columns.col(j));
        sums = {terms.sum(), n.dot(terms), n.cwiseAbs2().dot(terms)};
      } else {
        sums = power_sums(ratio, std::conj(ends[i]) * ends[j], samples);
      }
      gram(i, j) = sums[0];
      if (!slopes) continue;
      gram(count + i, j) = sums[1];
      gram(count + j, i) = std::conj(sums[1]);
      gram(count + i, count + j) = sums[2];
    }
  }
  return gram;
}

// The normal equations of columns scaled to length 1, from the lower triangle of their products.
struct Normal {
  Eigen::VectorXd scale;  // 1 / length of each column
  MatrixXcd factor;       // Cholesky's, in the lower triangle
  bool good;              // the products are positive definite

  explicit Normal(const MatrixXcd& gram) : scale(gram.diagonal().real().cwiseSqrt()) {
    scale = scale.array().max(1e-150).inverse();
    factor = scale.asDiagonal() * gram * scale.asDiagonal();
    factor.diagonal().array() += kRidge;
    good = dense::cholesky(factor);
  }
  // `right` is columns^H times the right side.
  [[nodiscard]] VectorXcd solve(const VectorXcd& right) const {
    VectorXcd solution = scale.asDiagonal() * right;
    dense::solve_cholesky(factor, solution);
    return scale.asDiagonal() * solution;
  }
  // Diagonal of the inverse of columns^H columns.
  [[nodiscard]] Eigen::VectorXd variances() const {
    MatrixXcd half = MatrixXcd::Identity(scale.size(), scale.size());
    dense::solve_lower(factor, half);
    return half.colwise().squaredNorm().transpose().cwiseProduct(scale.cwiseAbs2());
  }
};

// The least-squares fit of amplitudes to fixed poles.
struct State {
  VectorXcd poles, amplitudes, residual;
  MatrixXcd columns;
  double energy = INFINITY;  // of the residual
};

State fitted(const VectorXcd& signal, const VectorXcd& poles) {
  State state{.poles = poles, .columns = exponentials(poles, signal.size())};
  const Normal normal(products(poles, state.columns, false));
  if (!normal.good) return state;
  state.amplitudes = normal.solve(state.columns.adjoint() * signal);
  state.residual = signal - state.columns * state.amplitudes;
  state.energy = state.residual.squaredNorm();
  return state;
}

// The Gauss-Newton step of the poles. The model's derivatives are exp(p n) by an amplitude and a n exp(p n) by a pole.
// The step is solved for n exp(p n), whose lengths do not depend on amplitudes, and then divided by them.
VectorXcd step_of(const State& state, const Normal& normal) {
  const Index count = state.poles.size(), samples = state.columns.rows();
  const Eigen::VectorXd n = Eigen::VectorXd::LinSpaced(samples, 0, static_cast<double>(samples - 1));
  VectorXcd right(2 * count);
  right.head(count) = state.columns.adjoint() * state.residual;
  right.tail(count) = state.columns.adjoint() * n.cwiseProduct(state.residual);
  return normal.solve(right).tail(count).cwiseQuotient(state.amplitudes);
}

// Moves the poles, each by no more than the signal can resolve, and limits their growth.
VectorXcd moved(const State& state, const VectorXcd& by, double share) {
  const double max = 6.0 / static_cast<double>(state.columns.rows());
  VectorXcd poles = state.poles;
  for (Index k = 0; k < poles.size(); ++k) {
    const Complex step = share * by[k];
    poles[k] += std::abs(step) > max ? step * (max / std::abs(step)) : step;
    poles[k] = {std::min(poles[k].real(), max), poles[k].imag()};
  }
  return poles;
}

State descend(const VectorXcd& signal, State state) {
  for (int step = 0; step < kMaxSteps && std::isfinite(state.energy); ++step) {
    const Normal normal(products(state.poles, state.columns, true));
    if (!normal.good) break;
    const VectorXcd by = step_of(state, normal);
    State next;
    double share = 1;
    for (; share > 0.05; share /= 3) {
      next = fitted(signal, moved(state, by, share));
      if (next.energy <= state.energy) break;
    }
    if (!(next.energy <= state.energy)) break;
    const bool settled = next.energy > (1 - 1e-7) * state.energy;
    state = std::move(next);
    if (settled) break;
  }
  return state;
}

// Gives each term its errors. With `refined`, the poles are fitted as well as the amplitudes.
std::vector<Term> judged(const VectorXcd& signal, const State& state, bool refined) {
  const Normal normal(products(state.poles, state.columns, refined));
  if (!normal.good || !std::isfinite(state.energy)) return {};
  const Index count = state.poles.size(), unknowns = refined ? 2 * count : count;
  const double freedom = static_cast<double>(std::max<Index>(signal.size() - unknowns, 1));
  const double variance = std::max(state.energy / freedom, 1e-26 * signal.squaredNorm());
  const Eigen::VectorXd variances = variance * normal.variances();
  std::vector<Term> terms;
  for (Index k = 0; k < count; ++k) {
    const double size = std::abs(state.amplitudes[k]), of_pole = refined ? variances[count + k] / (size * size) : 0;
    terms.push_back({.pole = state.poles[k],
                     .amplitude = state.amplitudes[k],
                     .pole_error = std::sqrt(of_pole / 2),
                     .significance = size / std::sqrt(variances[k])});
  }
  return terms;
}

VectorXcd poles_of(const std::vector<Term>& terms) {
  VectorXcd poles(static_cast<Index>(terms.size()));
  for (std::size_t k = 0; k < terms.size(); ++k) poles[static_cast<Index>(k)] = terms[k].pole;
  return poles;
}

// Removes the weakest terms that are not significant, up to a share of all, but at least one. Two terms that nearly
// coincide both look weak, and each is strong once the other is removed. Therefore the last rounds remove one term at a
// time.
bool weed(std::vector<Term>& terms, double min, double share) {
  std::ranges::sort(terms, std::greater{}, &Term::significance);
  const auto max = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(share * static_cast<double>(terms.size())));
  std::ptrdiff_t weak = 0;
  for (; weak < max && !terms.empty() && !(terms.back().significance >= min); ++weak) terms.pop_back();
  return weak > 0;
}

}  // namespace

std::vector<Term> refine(const VectorXcd& signal, const std::vector<Complex>& poles) {
  const double max_growth = 3.0 / static_cast<double>(signal.size());
  std::vector<Term> terms;
  for (const Complex pole : poles) {
    if (pole.real() < max_growth) terms.push_back({.pole = pole});
  }
  if (terms.empty()) return {};
  // The first loop keeps the poles fixed, which is quick; the second refines them.
  do {
    const State state = fitted(signal, poles_of(terms));
    terms = judged(signal, state, false);
  } while (weed(terms, 0.5 * kSignificance, 0.25) && !terms.empty());
  do {
    const State state = descend(signal, fitted(signal, poles_of(terms)));
    terms = judged(signal, state, true);
  } while (weed(terms, kSignificance, 0) && !terms.empty());
  return terms;
}

}  // namespace ringdown::fit
