#include "engine/solve/methods.h"

#include <Eigen/CholmodSupport>
#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace ringdown::solve {
namespace {

constexpr int kFirstRequest = 40;  // modes
constexpr int kMaxRestarts = 200;

// (K - sigma M)^-1, as Spectra wants it.
class ShiftedInverse {
 public:
  using Scalar = double;

  ShiftedInverse(const fem::SparseMatrix& shifted, const Progress& progress) : progress_(progress) {
    factors_.cholmod().print = 0;
    factors_.compute(shifted);
  }
  [[nodiscard]] bool ok() const { return factors_.info() == Eigen::Success; }
  [[nodiscard]] int solves() const { return solves_; }
  void expect(int solves) { expected_ = solves_ + solves; }

  [[nodiscard]] Eigen::Index rows() const { return factors_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return factors_.cols(); }
  void set_shift(double) {}  // factored already
  void perform_op(const double* in, double* out) const {
    if (progress_ && solves_ % 8 == 0 && !progress_("modes", fraction())) throw Cancelled{};
    const Eigen::Map<const Eigen::VectorXd> right(in, rows());
    Eigen::Map<Eigen::VectorXd>(out, rows()) = factors_.solve(right);
    ++solves_;
  }

 private:
  [[nodiscard]] double fraction() const { return expected_ > 0 ? std::min(0.99, double(solves_) / expected_) : 0; }

  Eigen::CholmodSupernodalLLT<fem::SparseMatrix, Eigen::Lower> factors_;
  const Progress& progress_;
  int expected_ = 0;
  mutable int solves_ = 0;
};

class MassProduct {
 public:
  using Scalar = double;

  explicit MassProduct(const fem::SparseMatrix& node_mass) : node_mass_(node_mass) {}
  [[nodiscard]] Eigen::Index rows() const { return 3 * node_mass_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return rows(); }
  void perform_op(const double* in, double* out) const { fem::apply_mass(node_mass_, in, out); }

 private:
  const fem::SparseMatrix& node_mass_;
};

// How many modes to ask for next, so that the last is likely past the top: the count grows with frequency to
// a power between 1 (plates, bars) and 3 (solids), which the upper half of what was found tells.
int next_request(const Eigen::VectorXd& lambda, int rigid, double highest_lambda) {
  const auto found = static_cast<int>(lambda.size()), elastic = found - rigid;
  if (elastic < 8) return 3 * found;
  const double half = lambda[rigid + elastic / 2], last = lambda[found - 1];
  const double power = std::clamp(std::log(2.0) / std::log(std::max(1.01, last / half)), 0.5, 2.0);
  const double estimate = elastic * std::pow(highest_lambda / last, power);
  return rigid + 10 + static_cast<int>(std::min(1.12 * estimate, 8.0 * found));
}

// Asks Spectra for more and more of the modes nearest to the shift until one is past the top.
Result<Eigenmodes> iterate(const fem::System& system, const EigenRequest& request, double sigma, double rigid_limit,
                           ShiftedInverse& inverse) {
  using Solver = Spectra::SymGEigsShiftSolver<ShiftedInverse, MassProduct, Spectra::GEigsMode::ShiftInvert>;
  MassProduct mass(system.node_mass);
  const auto unknowns = static_cast<int>(system.unknowns());
  const int first = request.expected_modes > 0 ? request.expected_modes + 1 : kFirstRequest;
  for (int wanted = std::min(first, unknowns - 1);;) {
    const int basis = std::min(unknowns, 2 * wanted + 20);
    inverse.expect(basis + wanted);
    Solver solver(inverse, mass, wanted, basis, sigma);
    solver.init();
    solver.compute(Spectra::SortRule::LargestMagn, kMaxRestarts, request.tolerance, Spectra::SortRule::SmallestAlge);
    if (solver.info() != Spectra::CompInfo::Successful) {
      return fail(ErrorKind::refused, "the modes did not converge in " + std::to_string(kMaxRestarts) +
                                          " restarts; look for needle-like elements in the mesh");
    }
    Eigenmodes modes;
    modes.lambda = solver.eigenvalues();
    modes.rigid = count_below(modes.lambda, rigid_limit);
    const auto in_band = (modes.lambda.array() <= request.highest_lambda).count();
    if (in_band - modes.rigid > request.most_modes) {
      return fail(too_many_modes(request));
    }
    if (in_band < wanted || wanted == unknowns - 1) {
      modes.shapes = solver.eigenvectors();
      return modes;
    }
    wanted = next_request(modes.lambda, modes.rigid, request.highest_lambda);
    wanted = std::min({wanted, unknowns - 1, request.most_modes + modes.rigid + 1});
  }
}

}  // namespace

// The shift is a small negative one, scaled to the problem, because K is singular. The request grows until one mode
// past the top is found.
Result<Eigenmodes> solve_spectra(const fem::System& system, const EigenRequest& request, RigidLimit rigid_limit,
                                 const Progress& progress) {
  const double sigma = -1e-4 * request.highest_lambda;
  const double start = seconds_now();
  if (progress && !progress("factors", 0)) throw Cancelled{};
  ShiftedInverse inverse(shifted_stiffness(system, sigma), progress);
  if (!inverse.ok()) return fail(not_factored(system));
  const double factored = seconds_now();
  Result<Eigenmodes> modes = iterate(system, request, sigma, rigid_limit, inverse);
  if (!modes) return modes;
  modes->factorizations = 1;
  modes->factor_seconds = factored - start;
  modes->iterate_seconds = seconds_now() - factored;
  modes->solves = inverse.solves();
  return modes;
}

}  // namespace ringdown::solve
