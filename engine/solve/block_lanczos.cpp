// The iteration, step by step.
//
// step() multiplies the last block by the operator and makes the result M-orthogonal to the basis and the locked
// vectors, then M-orthonormal: this is the next block. The coefficients form the block tridiagonal projection of the
// operator. At intervals decompose() finds the projection's eigenvalues, the Ritz values; their residuals follow from
// the last rows of the eigenvectors. harvest() walks from the shift outwards, to either side, as long as Ritz values
// have converged. The iteration ends when the window is complete or the basis is full.
#include "engine/solve/block_lanczos.h"

#include "engine/dense/decompositions.h"
#include "engine/solve/basis.h"
#include "engine/solve/methods.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

extern "C" void dsyevd_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* w,
                        double* work, const int* lwork, int* iwork, const int* liwork, int* info);

namespace ringdown::solve {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Returns the eigenvalues in ascending order and replaces `matrix` by the eigenvectors. Only the lower triangle of
// `matrix` is read. LAPACK's divide and conquer takes a fifth of the time of Eigen's QR on 400 rows.
VectorXd eigen_decompose(MatrixXd& matrix) {
  const int n = static_cast<int>(matrix.rows());
  VectorXd values(n);
  double work_size = 0;
  int iwork_size = 0, info = 0, query = -1;
  dsyevd_("V", "L", &n, matrix.data(), &n, values.data(), &work_size, &query, &iwork_size, &query, &info);
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> iwork(iwork_size);
  const int lwork = static_cast<int>(work.size());
  dsyevd_("V", "L", &n, matrix.data(), &n, values.data(), work.data(), &lwork, iwork.data(), &iwork_size, &info);
  if (info != 0) throw std::runtime_error("LAPACK's dsyevd did not converge");
  return values;
}

class Iteration {
 public:
  Iteration(const Pencil& pencil, const Window& window, const MatrixXd& locked, unsigned seed)
      : system_(pencil.ordered()),
        factors_(pencil.factors()),
        team_(pencil.team()),
        window_(window),
        random_(seed),
        basis_(team_),
        locked_(team_),
        mass_locked_(team_) {
    const Eigen::Index max = std::min<Eigen::Index>(window.max_vectors, system_.unknowns() - locked.cols());
    capacity_ = static_cast<int>(std::max<Eigen::Index>(2, max / kWidth)) * kWidth;
    projected_ = MatrixXd::Zero(capacity_, capacity_);
    start(locked);
  }

  [[nodiscard]] int size() const { return basis_.size(); }
  [[nodiscard]] int solves() const { return solves_; }
  [[nodiscard]] bool full() const { return size() + kWidth > capacity_; }

  // Multiplies the last block by the operator and adds the next one to the basis.
  void step() {
    if (stepped_ > 0) append();
    copy(team_, mass_last_, next_);
    factors_.solve(next_);
    solves_ += kWidth;
    // The three-term recurrence comes first: after it, little of the block lies in the span of the basis.
    const int last = size() - kWidth, blocks = size() / kWidth;
    if (blocks > 1) basis_.subtract_combination(blocks - 2, coupling_.transpose(), next_);
    Small diagonal = inner_products(team_, mass_last_, next_);
    diagonal = (0.5 * (diagonal + diagonal.transpose())).eval();
    basis_.subtract_combination(blocks - 1, diagonal, next_);
    const MatrixXd correction = orthogonalize(next_);
    const Small extra = correction.bottomRows(kWidth);
    diagonal += 0.5 * (extra + extra.transpose());
    projected_.block(last, last, kWidth, kWidth) = diagonal;
    coupling_ = normalize();
    ++stepped_;
  }

  // Finds the eigenpairs of the projection: Ritz values theta, and the distance of each from an eigenvalue of the
  // operator.
  void decompose() {
    vectors_ = projected_.topLeftCorner(size(), size());
    theta_ = eigen_decompose(vectors_);
    residual_ = (coupling_ * vectors_.bottomRows(kWidth)).colwise().norm();
  }

  [[nodiscard]] double lambda(int i) const { return factors_.sigma() + 1 / theta_[i]; }
  [[nodiscard]] bool converged(int i) const { return residual_[i] <= window_.tolerance * std::abs(theta_[i]); }

  // Returns V s + (next block) (coupling s) / theta: each Ritz vector multiplied by the operator once more, without a
  // solve.
  [[nodiscard]] MatrixXd shapes(const std::vector<int>& which) const {
    MatrixXd inside(size(), which.size()), outside(kWidth, which.size());
    for (std::size_t k = 0; k < which.size(); ++k) {
      const int i = which[k];
      inside.col(static_cast<Eigen::Index>(k)) = vectors_.col(i);
      outside.col(static_cast<Eigen::Index>(k)) = coupling_ * vectors_.col(i).tail<kWidth>() / theta_[i];
    }
    MatrixXd result = basis_.combine(inside);
    result.noalias() += next_.transpose() * outside;
    return result;
  }

 private:
  void start(const MatrixXd& locked) {
    for (Eigen::Index k = 0; k < locked.cols(); k += kWidth) {
      const Eigen::Index width = std::min<Eigen::Index>(kWidth, locked.cols() - k);
      Block block = Block::Zero(kWidth, system_.unknowns()), product;
      block.topRows(width) = locked.middleCols(k, width).transpose();
      system_.times_mass(block, product);
      locked_.append(block);
      mass_locked_.append(product);
    }
    Block noise(kWidth, system_.unknowns());
    std::normal_distribution<double> normal;
    for (double& value : noise.reshaped()) value = normal(random_);
    system_.times_mass(noise, next_);
    factors_.solve(next_);  // a smooth start
    solves_ += kWidth;
    orthogonalize(next_);
    normalize();
    append();
  }

  void append() {
    if (stepped_ > 0) projected_.block(size(), size() - kWidth, kWidth, kWidth) = coupling_;
    basis_.append(next_);
    std::swap(mass_last_, mass_next_);
  }

  // Makes a block M-orthogonal to the basis and the locked vectors; returns the coefficients of the basis. Repeats the
  // pass while it removes a large share of the block, because rounding then leaves too much (Daniel, Gragg, Kaufman &
  // Stewart 1976).
  MatrixXd orthogonalize(Block& block) {
    MatrixXd total = MatrixXd::Zero(size(), kWidth);
    for (int pass = 0; pass < 3; ++pass) {
      system_.times_mass(block, mass_next_);
      const Eigen::Array<double, kWidth, 1> before = inner_products(team_, block, mass_next_).diagonal();
      const MatrixXd inside = basis_.inner_products(mass_next_);
      locked_.subtract_combination(mass_locked_.inner_products(block), block);
      basis_.subtract_combination(inside, block);
      total += inside;
      const Eigen::Array<double, kWidth, 1> taken = inside.colwise().squaredNorm().transpose();
      if ((taken < 1e-4 * before).all()) break;
    }
    return total;
  }

  // Makes `next` M-orthonormal: next_before^T = next_after^T R. Directions that vanish are replaced by random ones,
  // with a zero in R.
  Small normalize() {
    system_.times_mass(next_, mass_next_);
    Small factor = Small::Identity();
    for (int pass = 0; pass < 2; ++pass) {
      Small gram = inner_products(team_, next_, mass_next_);
      gram = (0.5 * (gram + gram.transpose())).eval();
      if (pass == 0) {
        const dense::Spectrum spectrum = dense::spectrum(gram);
        if (spectrum.values[0] <= 1e-18 * spectrum.values[kWidth - 1]) return rescue(spectrum);
        // The first pass divides along the principal axes, because the condition may be up to 1e9 (Stathopoulos & Wu,
        // SIAM J. Sci. Comput. 23, 2002).
        const auto root = spectrum.values.cwiseSqrt();
        const Small inverse = root.cwiseInverse().asDiagonal() * spectrum.vectors.transpose();
        combine_in_place(team_, inverse, next_);
        factor = root.asDiagonal() * spectrum.vectors.transpose();
        system_.times_mass(next_, mass_next_);
      } else {
        MatrixXd lower = gram, identity = Small::Identity();
        dense::cholesky(lower);
        dense::solve_lower(lower, identity);
        const Small inverse = identity;
        combine_in_place(team_, inverse, next_);
        combine_in_place(team_, inverse, mass_next_);
        factor = Small(lower).triangularView<Eigen::Lower>().transpose() * factor;
      }
    }
    return factor;
  }

  // normalize() for a block whose vectors are linearly dependent.
  Small rescue(const dense::Spectrum& spectrum) {
    Small factor = Small::Zero();
    combine_in_place(team_, spectrum.vectors.transpose(), next_);
    std::normal_distribution<double> normal;
    for (int i = 0; i < kWidth; ++i) {
      const double square = spectrum.values[i];
      if (square > 1e-20 * spectrum.values[kWidth - 1] && square > 0) {
        next_.row(i) /= std::sqrt(square);
        factor.row(i) = std::sqrt(square) * spectrum.vectors.col(i).transpose();
      } else {
        for (Eigen::Index u = 0; u < next_.cols(); ++u) next_(i, u) = normal(random_);
      }
    }
    orthogonalize(next_);
    // The good directions are made orthonormal first, so that `factor` still describes them.
    for (int i = kWidth - 1; i >= 0; --i) {
      for (int pass = 0; pass < 2; ++pass) {
        system_.times_mass(next_, mass_next_);
        for (int j = kWidth - 1; j > i; --j) {
          const double share = mass_next_.row(j).dot(next_.row(i));
          next_.row(i) -= share * next_.row(j);
        }
        system_.times_mass(next_, mass_next_);
        next_.row(i) /= std::sqrt(mass_next_.row(i).dot(next_.row(i)));
      }
    }
    system_.times_mass(next_, mass_next_);
    return factor;
  }

  const OrderedSystem& system_;
  const Ldlt& factors_;
  Team& team_;
  const Window& window_;
  std::mt19937_64 random_;
  Basis basis_, locked_, mass_locked_;
  MatrixXd projected_;  // the operator's projection; lower triangle
  Block next_;          // the block that follows the basis
  Block mass_last_, mass_next_;
  Small coupling_ = Small::Zero();
  int capacity_ = 0, stepped_ = 0, solves_ = 0;
  MatrixXd vectors_;
  VectorXd theta_, residual_;
};

// The converged Ritz values of a window, ascending in lambda. On either side of the shift they end at the first value
// that has not converged.
struct Harvest {
  std::vector<int> found;
  bool complete = false;
};

template <class It, class Inside>
int harvest_side(const Iteration& iteration, It begin, It end, Inside inside, std::vector<int>& found) {
  const It stop =
      std::find_if(begin, end, [&](int i) { return !iteration.converged(i) || !inside(iteration.lambda(i)); });
  found.insert(found.end(), begin, stop);
  return static_cast<int>(stop - begin);
}

Harvest harvest(const Iteration& iteration, const Window& window, double sigma) {
  const auto lambda = [&](int i) { return iteration.lambda(i); };
  const auto ascending = [&](int a, int b) { return lambda(a) < lambda(b); };
  std::vector<int> order(iteration.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), ascending);
  const auto shift = std::partition_point(order.begin(), order.end(), [&](int i) { return lambda(i) < sigma; });
  Harvest result;
  const int right = harvest_side(
      iteration, shift, order.end(), [&](double l) { return l < window.high; }, result.found);
  const int left = harvest_side(
      iteration, std::make_reverse_iterator(shift), order.rend(), [&](double l) { return l >= window.low; },
      result.found);
  std::sort(result.found.begin(), result.found.end(), ascending);
  result.complete = left >= window.left && right >= window.right;
  return result;
}

}  // namespace

Pairs block_lanczos(const Pencil& pencil, const Window& window, const MatrixXd& locked, unsigned seed,
                    const KeepGoing& keep_going) {
  Iteration iteration(pencil, window, locked, seed);
  Harvest crop;
  const int expected = window.left + window.right;
  const double likely = 1.7 * expected + 20 * kWidth;
  for (int next_check = std::max(4 * kWidth, 5 * expected / 4 + 6 * kWidth);;) {
    if (keep_going && !keep_going(std::min(0.99, iteration.size() / likely))) throw Cancelled{};
    iteration.step();
    if (iteration.size() < next_check && !iteration.full()) continue;
    iteration.decompose();
    crop = harvest(iteration, window, pencil.factors().sigma());
    if (crop.complete || iteration.full()) break;
    next_check = iteration.size() + std::max(2 * kWidth, iteration.size() / 10);
  }
  Pairs pairs{.shapes = iteration.shapes(crop.found), .solves = iteration.solves(), .complete = crop.complete};
  for (const int i : crop.found) pairs.lambda.push_back(iteration.lambda(i));
  return pairs;
}

}  // namespace ringdown::solve
