#include "engine/bake/nonlinear_modes.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/fem/quadratic_strain.h"
#include "engine/solve/slaved_response.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <random>
#include <utility>

// Pairs of modes form a space: a symmetric matrix X stands for the field sum X_ij E2_ij / (omega_i omega_j), and
// T(X)_ij = <E2_ij / (omega_i omega_j), that field condensed> is a symmetric operator on such matrices, never negative.
// Products of matrices below are sums over all entries. One application is a force, a solve and a product with all
// pairs (Operator).
//
// 1. Random X, a few more than K; Y = T(X); X := an orthonormal basis of Y (one power iteration); Y := T(X) again.
// 2. Nystrom: T is nearly Y C^-1 Y^T with C = X^T Y. So Y C^(-1/2) are the products of all pairs with orthonormal
//    fields B, and the same combination of the forces' modal parts is g.
// 3. A rotation of the B sorts them by size; K stay.
// 4. A few fresh random X show what is missing: the trace of T - Y C^-1 Y^T.
namespace ringdown::bake {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kSpare = 10, kProbes = 6;
constexpr int kCarried = 6;          // modes whose own term is compared
constexpr double kShift = -1e-3;     // of the lowest mode's eigenvalue
constexpr double kFamily = 2e-3;     // relative, of frequencies that count as equal
constexpr double kRounding = 1e-11;  // of C's eigenvalues

class Operator {
 public:
  Operator(const fem::QuadraticStrain& strain, const solve::SlavedResponse& response, const VectorXd& lambda,
           const MatrixXd& shapes)
      : strain_(strain), response_(response), per_omega_(lambda.cwiseSqrt().cwiseInverse()), shapes_(shapes) {}

  [[nodiscard]] Index modes() const { return per_omega_.size(); }

  // Y = T(X), M^2 x s each; the forces' modal parts go to `modal`, M x s. False when `step` says no.
  bool apply(const MatrixXd& x, MatrixXd& y, MatrixXd& modal, const std::function<bool()>& step) const {
    const Index m = modes();
    MatrixXd forces(shapes_.rows(), x.cols());
    for (Index s = 0; s < x.cols(); ++s) {
      if (!step()) return false;
      forces.col(s) = strain_.force(mixture(x, s));
    }
    modal = dense::transposed_product(shapes_, forces);
    const MatrixXd answers = response_(forces);
    y.resize(m * m, x.cols());
    for (Index s = 0; s < x.cols(); ++s) {
      if (!step()) return false;
      y.col(s) = weighted(strain_.products(mixture(x, s), answers.col(s))).reshaped();
    }
    return true;
  }

 private:
  [[nodiscard]] MatrixXd weighted(const MatrixXd& pairs) const {
    return per_omega_.asDiagonal() * pairs * per_omega_.asDiagonal();
  }
  [[nodiscard]] MatrixXd mixture(const MatrixXd& x, Index s) const {
    return weighted(x.col(s).reshaped(modes(), modes()));
  }

  const fem::QuadraticStrain& strain_;
  const solve::SlavedResponse& response_;
  const VectorXd per_omega_;
  const MatrixXd& shapes_;  // of the M modes
};

// Symmetric matrices of normal numbers, of variance 1 in every orthonormal direction.
MatrixXd random_pairs(Index modes, Index count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  MatrixXd pairs(modes * modes, count);
  for (Index s = 0; s < count; ++s) {
    auto x = pairs.col(s).reshaped(modes, modes);
    for (Index j = 0; j < modes; ++j) {
      x(j, j) = normal(random);
      for (Index i = j + 1; i < modes; ++i) x(i, j) = x(j, i) = std::sqrt(0.5) * normal(random);
    }
  }
  return pairs;
}

// C^(-1/2) without the directions that are rounding: s x r.
MatrixXd inverse_root(const MatrixXd& c) {
  const dense::Spectrum solved = dense::spectrum(0.5 * (c + c.transpose()));
  const VectorXd& values = solved.values;
  Index first = 0;
  while (first < values.size() && values[first] <= kRounding * values[values.size() - 1]) ++first;
  const Index count = values.size() - first;
  return solved.vectors.rightCols(count) * values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
}

// The largest change of a low mode's own quartic term by the forces that condensing leaves out, over that term or,
// where a mode hardly stretches, over what it would be if it stretched as the mean of these modes does.
double carried_share(const fem::QuadraticStrain& strain, const solve::SlavedResponse& response,
                     const VectorXd& lambda) {
  const Index modes = lambda.size(), low = std::min<Index>(modes, kCarried);
  VectorXd terms(low), changes(low);
  for (Index m = 0; m < low; ++m) {
    MatrixXd mixture = MatrixXd::Zero(modes, modes);
    mixture(m, m) = 1;
    const VectorXd force = strain.force(mixture), full = force + strain.carried_force(m);
    MatrixXd both(force.size(), 2);
    both << force, full;
    const MatrixXd answers = response(both);
    terms[m] = strain.products(mixture, answers.col(0))(m, m);
    changes[m] = std::abs(full.dot(answers.col(1)) - force.dot(answers.col(0)));
  }
  const double mean = terms.cwiseQuotient(lambda.head(low)).mean();
  return changes.cwiseQuotient(terms.cwiseMax(mean * lambda.head(low))).maxCoeff();
}

MatrixXd lower_triangles(const MatrixXd& pairs, const VectorXd& omega) {
  const Index m = omega.size();
  MatrixXd rows(pairs.cols(), m * (m + 1) / 2);
  for (Index k = 0; k < pairs.cols(); ++k) {
    const auto h = pairs.col(k).reshaped(m, m);
    Index at = 0;
    for (Index i = 0; i < m; ++i) {
      for (Index j = 0; j <= i; ++j) rows(k, at++) = omega[i] * omega[j] * 0.5 * (h(i, j) + h(j, i));
    }
  }
  return rows;
}

}  // namespace

MatrixXd NonlinearModes::matrix(Index k) const {
  MatrixXd h(modes(), modes());
  Index at = 0;
  for (Index i = 0; i < modes(); ++i) {
    for (Index j = 0; j <= i; ++j) h(i, j) = h(j, i) = bending(k, at++);
  }
  return h;
}

int nonlinear_functions(int modes) { return std::min({modes * (modes + 1) / 2, std::max(20, modes * 3 / 5), 60}); }

Result<NonlinearModes> find_nonlinear(const mesh::TetMesh& unit_mesh, const fem::Elastic& elastic,
                                      const fem::System& system, const VectorXd& all_lambda, const MatrixXd& all_shapes,
                                      int rigid, int modes, const Progress& progress) try {
  const Index m = modes, max = m * (m + 1) / 2;
  const VectorXd lambda = all_lambda.segment(rigid, m), omega = lambda.cwiseSqrt();
  const MatrixXd kept = all_shapes.leftCols(rigid + m), shapes = kept.rightCols(m);
  const int wanted = nonlinear_functions(modes);
  const Index count = std::min<Index>(wanted + kSpare, max);
  const double steps = static_cast<double>(2 * (2 * count + kProbes));
  int step = 0;
  const auto go_on = [&] { return !progress || progress("nonlinear", std::min(0.99, step++ / steps)); };

  if (progress && !progress("nonlinear", 0)) return fail_cancelled();
  solve::SlavedResponse response(system, kept, kShift * lambda[0]);
  if (auto done = response.factor([&] { return !progress || progress("nonlinear", 0); }); !done) return fail(done);
  const dense::BlasThreads one(1);
  const fem::QuadraticStrain strain(unit_mesh, elastic, shapes);
  const Operator apply(strain, response, lambda, shapes);

  std::mt19937 random(31);
  MatrixXd x = random_pairs(m, count, random), y, modal;
  if (!apply.apply(x, y, modal, go_on)) return fail_cancelled();
  x = dense::orthonormal_basis(std::move(y));
  if (!apply.apply(x, y, modal, go_on)) return fail_cancelled();
  const MatrixXd root = inverse_root(dense::transposed_product(x, y));
  const MatrixXd pairs = dense::product(y, root);  // H of each field, over omega_i omega_j
  const dense::Spectrum sizes = dense::spectrum(dense::transposed_product(pairs, pairs));
  const Index kept_fields = std::min<Index>(wanted, pairs.cols());
  const MatrixXd turn = sizes.vectors.rightCols(kept_fields).rowwise().reverse();
  const MatrixXd best = dense::product(pairs, turn);

  NonlinearModes result;
  result.bending = lower_triangles(best, omega);
  result.curving = dense::product(dense::product(modal, root), turn).transpose();
  if (count < max) {
    const MatrixXd probes = random_pairs(m, kProbes, random);
    MatrixXd answers;
    if (!apply.apply(probes, answers, modal, go_on)) return fail_cancelled();
    const double missing =
        (probes.cwiseProduct(answers).sum() - dense::transposed_product(best, probes).squaredNorm()) / kProbes;
    result.residual = std::max(0.0, missing) / (std::max(0.0, missing) + best.squaredNorm());
  }
  result.membrane_share = (result.curving.colwise().squaredNorm().transpose().cwiseQuotient(lambda)).maxCoeff();
  result.carried_share = carried_share(strain, response, lambda);
  return result;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::no_memory, "not enough memory for {} nonlinear modes; ask for fewer, or make the mesh coarser",
              modes);
}

VectorXd own_hardening(const NonlinearModes& modes, const VectorXd& lambda) {
  const Index m = modes.modes();
  VectorXd own(m);
  for (Index first = 0; first < m;) {
    Index end = first + 1;
    while (end < m && std::sqrt(lambda[end] / lambda[first]) - 1 < kFamily) ++end;
    const auto size = static_cast<double>(end - first);
    double sum = 0;  // mean of (q^T H q)^2 over the unit sphere: (tr H)^2 + 2 tr H^2, over n (n + 2)
    for (Index k = 0; k < modes.functions(); ++k) {
      const MatrixXd h = modes.matrix(k).block(first, first, end - first, end - first);
      sum += h.trace() * h.trace() + 2 * h.squaredNorm();
    }
    const double mean = lambda.segment(first, end - first).mean();
    own.segment(first, end - first).setConstant(sum / (size * (size + 2) * mean * mean));
    first = end;
  }
  return own;
}

}  // namespace ringdown::bake
