#include "engine/solve/spectra.h"

#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/solve/methods.h"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace ringdown::solve {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxRestarts = 200;
constexpr int kSpareVectors = 16;  // of the basis, beyond two per mode; six modes then converge without a restart

// The operator scale (K - sigma M)^-1, M-orthogonal to the locked vectors, with the interface that Spectra requires.
// Spectra compares numbers with absolute thresholds near 1e-16, so the operator is scaled to eigenvalues near 1,
// independent of the units of K and M.
class ShiftedInverse {
 public:
  using Scalar = double;

  ShiftedInverse(const Pencil& pencil, double scale, const MatrixXd& locked, const KeepGoing& keep_going)
      : pencil_(pencil),
        scale_(scale),
        locked_(locked),
        mass_locked_(fem::mass_times(pencil.system().node_mass, locked)),
        keep_going_(keep_going),
        ordered_(pencil.unknowns()) {}

  void expect(int solves) { expected_ = solves; }
  [[nodiscard]] int solves() const { return solves_; }

  [[nodiscard]] Eigen::Index rows() const { return pencil_.unknowns(); }
  [[nodiscard]] Eigen::Index cols() const { return rows(); }
  void set_shift(double) {}  // the pencil is factored already
  void perform_op(const double* in, double* out) const {
    if (keep_going_ && !keep_going_(std::min(0.99, static_cast<double>(solves_) / expected_))) throw Cancelled{};
    const std::vector<int>& old_of = pencil_.plan().old_of;
    const Eigen::Map<const VectorXd> right(in, rows());
    Eigen::Map<VectorXd> result(out, rows());
    for (std::size_t n = 0; n < old_of.size(); ++n) ordered_.segment<3>(3 * n) = right.segment<3>(3 * old_of[n]);
    pencil_.factors().solve(ordered_);
    for (std::size_t n = 0; n < old_of.size(); ++n)
      result.segment<3>(3 * old_of[n]) = scale_ * ordered_.segment<3>(3 * n);
    if (locked_.cols() > 0) result.noalias() -= locked_ * (mass_locked_.transpose() * result);
    ++solves_;
  }

 private:
  const Pencil& pencil_;
  const double scale_;
  const MatrixXd& locked_;
  const MatrixXd mass_locked_;
  const KeepGoing& keep_going_;
  int expected_ = 1;
  mutable VectorXd ordered_;  // vector in the order of elimination
  mutable int solves_ = 0;
};

// The product M x, with the interface that Spectra requires. Spectra multiplies each residual twice, for its norm and
// for its inner products with the basis. The second product is a copy of the first, which saves a third of all
// products.
class MassProduct {
 public:
  using Scalar = double;

  explicit MassProduct(const fem::SparseMatrix& node_mass)
      : node_mass_(node_mass), last_in_(VectorXd::Zero(rows())), last_out_(VectorXd::Zero(rows())) {}
  [[nodiscard]] Eigen::Index rows() const { return 3 * node_mass_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return rows(); }
  void perform_op(const double* in, double* out) const {
    if (!std::equal(in, in + rows(), last_in_.data())) {
      last_in_ = Eigen::Map<const VectorXd>(in, rows());
      fem::apply_mass(node_mass_, in, last_out_.data());
    }
    Eigen::Map<VectorXd>(out, rows()) = last_out_;
  }

 private:
  const fem::SparseMatrix& node_mass_;
  mutable VectorXd last_in_, last_out_;
};

// Multiplies the shapes by the operator once more, kWidth at a time. This removes remainders of the mesh's highest
// eigenvectors, which weigh most in K phi - lambda M phi (Ericsson & Ruhe 1980).
MatrixXd purified(const Pencil& pencil, const MatrixXd& shapes) {
  MatrixXd ordered = pencil.in_elimination_order(shapes);
  Block block = Block::Zero(kWidth, shapes.rows()), heavy;
  for (Eigen::Index first = 0; first < shapes.cols(); first += kWidth) {
    const Eigen::Index width = std::min<Eigen::Index>(kWidth, shapes.cols() - first);
    block.topRows(width) = ordered.middleCols(first, width).transpose();
    pencil.ordered().times_mass(block, heavy);
    pencil.factors().solve(heavy);
    ordered.middleCols(first, width) = heavy.topRows(width).transpose();
  }
  ordered.colwise().normalize();
  return pencil.in_mesh_order(ordered);
}

// Makes shapes M-orthonormal, and M-orthogonal to the locked ones. Each column is made orthogonal to the columns before
// it. The shapes nearest to the shift come first, because the multiplication enlarges their share in the others.
MatrixXd orthonormal(const fem::SparseMatrix& node_mass, MatrixXd shapes, const MatrixXd& locked) {
  for (int pass = 0; pass < 2; ++pass) {
    if (locked.cols() > 0) shapes -= locked * (locked.transpose() * fem::mass_times(node_mass, shapes)).eval();
    MatrixXd lower = dense::transposed_product(shapes, fem::mass_times(node_mass, shapes));
    dense::cholesky(lower);
    dense::divide_by_upper(lower, shapes);
  }
  return shapes;
}

}  // namespace

Pairs nearest_by_spectra(const Pencil& pencil, int count, double tolerance, const MatrixXd& locked,
                         const KeepGoing& keep_going) {
  using Solver = Spectra::SymGEigsShiftSolver<ShiftedInverse, MassProduct, Spectra::GEigsMode::ShiftInvert>;
  const auto free = static_cast<int>(pencil.unknowns() - locked.cols());
  const int wanted = std::min(count, free - 1), basis = std::min(free, 2 * wanted + kSpareVectors);
  const double sigma = pencil.factors().sigma(), scale = std::abs(sigma);
  ShiftedInverse inverse(pencil, scale, locked, keep_going);
  inverse.expect(basis + 2 * wanted);
  MassProduct mass(pencil.system().node_mass);
  Solver solver(inverse, mass, wanted, basis, sigma / scale);
  // Each run has another start, because one start leads to only one vector of a multiple eigenvalue, and this vector is
  // locked now.
  std::mt19937_64 random(1 + locked.cols());
  std::normal_distribution<double> normal;
  const VectorXd noise = VectorXd::NullaryExpr(pencil.unknowns(), [&] { return normal(random); });
  solver.init(noise.data());
  solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, tolerance, Spectra::SortRule::SmallestAlge);
  const VectorXd lambda = scale * solver.eigenvalues();
  std::vector<Eigen::Index> order(lambda.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return std::abs(lambda[a] - sigma) < std::abs(lambda[b] - sigma); });
  Pairs pairs{.solves = inverse.solves() + static_cast<int>(order.size()),
              .complete = solver.info() == Spectra::CompInfo::Successful};
  for (const Eigen::Index i : order) pairs.lambda.push_back(lambda[i]);
  pairs.shapes =
      orthonormal(pencil.system().node_mass, purified(pencil, solver.eigenvectors()(Eigen::all, order)), locked);
  return pairs;
}

// K is singular, so the shift is a small negative one, scaled to the band. There (K - sigma M)^-1 is positive definite,
// and the lowest modes are those nearest to the shift. The count at the top says how many modes to ask for. A run may
// miss vectors of a multiple eigenvalue and find modes above the top instead. The modes below the top are then locked,
// and the next run looks for the missing ones.
Result<Eigenmodes> solve_spectra(Pencil& pencil, const Count& top, const EigenRequest& request,
                                 const Progress& progress) {
  if (auto shift = pencil.factor(-1e-4 * request.highest_lambda, Pencil::kDown,
                                 [&](double) { return !progress || progress("factors", 0); });
      !shift) {
    return fail(shift);
  }
  pencil.release_workspace();
  const double start = seconds_now();
  Eigenmodes modes;
  std::vector<double> lambda;
  MatrixXd shapes(pencil.unknowns(), 0);
  for (bool found_more = true; found_more && static_cast<int>(lambda.size()) < top.below;) {
    const auto found = static_cast<int>(lambda.size());
    const Pairs pairs = nearest_by_spectra(pencil, top.below - found, request.tolerance, shapes, [&](double share) {
      return !progress || progress("modes", (found + share * (top.below - found)) / top.below);
    });
    modes.solves += pairs.solves;
    const auto below =
        std::count_if(pairs.lambda.begin(), pairs.lambda.end(), [&](double l) { return l < top.lambda; });
    lambda.insert(lambda.end(), pairs.lambda.begin(), pairs.lambda.begin() + below);
    shapes.conservativeResize(Eigen::NoChange, found + below);
    shapes.rightCols(below) = pairs.shapes.leftCols(below);
    found_more = below > 0;
  }
  std::vector<Eigen::Index> order(lambda.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return lambda[a] < lambda[b]; });
  modes.lambda = Eigen::Map<const VectorXd>(lambda.data(), static_cast<Eigen::Index>(lambda.size()))(order);
  modes.shapes = shapes(Eigen::all, order);
  modes.iterate_seconds = seconds_now() - start;
  return modes;
}

}  // namespace ringdown::solve
