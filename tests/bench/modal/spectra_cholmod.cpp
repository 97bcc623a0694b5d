#include "tests/bench/modal/spectra_cholmod.h"

#include <Eigen/CholmodSupport>
#include <Spectra/MatOp/SparseSymMatProd.h>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <chrono>

namespace ringdown::bench {
namespace {

constexpr int kMaxRestarts = 200;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Of all unknowns, lower triangle.
fem::SparseMatrix mass_matrix(const fem::System& system) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index n = 0; n < system.node_mass.outerSize(); ++n) {
    for (fem::SparseMatrix::InnerIterator m(system.node_mass, n); m; ++m) {
      if (m.row() < n) continue;
      for (int i = 0; i < 3; ++i) entries.emplace_back(3 * m.row() + i, 3 * n + i, m.value());
    }
  }
  fem::SparseMatrix mass(system.unknowns(), system.unknowns());
  mass.setFromTriplets(entries.begin(), entries.end());
  return mass;
}

// (K - sigma M)^-1, in the form that Spectra asks for.
class ShiftedInverse {
 public:
  using Scalar = double;

  explicit ShiftedInverse(const fem::SparseMatrix& shifted) {
    factors_.cholmod().print = 0;
    factors_.compute(shifted);
  }
  [[nodiscard]] bool ok() const { return factors_.info() == Eigen::Success; }
  [[nodiscard]] int solves() const { return solves_; }

  [[nodiscard]] Eigen::Index rows() const { return factors_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return factors_.cols(); }
  void set_shift(double) {}  // factored already
  void perform_op(const double* in, double* out) const {
    const Eigen::Map<const Eigen::VectorXd> right(in, rows());
    Eigen::Map<Eigen::VectorXd>(out, rows()) = factors_.solve(right);
    ++solves_;
  }

 private:
  Eigen::CholmodSupernodalLLT<fem::SparseMatrix, Eigen::Lower> factors_;
  mutable int solves_ = 0;
};

}  // namespace

Result<solve::Eigenmodes> solve_by_spectra_over_cholmod(const fem::System& system, const solve::EigenRequest& request,
                                                        int count) {
  using Mass = Spectra::SparseSymMatProd<double>;
  using Solver = Spectra::SymGEigsShiftSolver<ShiftedInverse, Mass, Spectra::GEigsMode::ShiftInvert>;
  const double sigma = -1e-4 * request.highest_lambda, start = now_s();
  const fem::SparseMatrix lower_mass = mass_matrix(system);
  ShiftedInverse inverse(system.stiffness - sigma * lower_mass);
  if (!inverse.ok()) return fail(ErrorKind::bad_input, "CHOLMOD could not factor the stiffness");
  const double factored = now_s();
  Mass mass(lower_mass);
  const auto unknowns = static_cast<int>(system.unknowns());
  const int wanted = std::min(count + 1, unknowns - 1);
  Solver solver(inverse, mass, wanted, std::min(unknowns, 2 * wanted + 20), sigma);
  solver.init();
  solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, request.tolerance, Spectra::SortRule::SmallestAlge);
  if (solver.info() != Spectra::CompInfo::Successful) return fail(ErrorKind::refused, "Spectra did not converge");
  solve::Eigenmodes modes;
  modes.lambda = solver.eigenvalues();
  modes.shapes = solver.eigenvectors();
  modes.solves = inverse.solves();
  modes.factorizations = 1;
  modes.factor_seconds = factored - start;
  modes.iterate_seconds = now_s() - factored;
  return modes;
}

}  // namespace ringdown::bench
