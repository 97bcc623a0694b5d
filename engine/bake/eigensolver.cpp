#include "engine/bake/eigensolver.h"

#include <Eigen/CholmodSupport>
#include <Eigen/Eigenvalues>
#include <Spectra/SymGEigsShiftSolver.h>
#include <cblas.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

namespace ringdown::bake {
namespace {

constexpr int kSmallProblem = 300;  // unknowns; below, dense algebra is quicker and sure
constexpr int kFirstRequest = 40;   // modes
constexpr int kMostRestarts = 200;

struct Cancelled {};

// Two threads gained nothing in single-vector solves (bell: 14.3 s against 14.7 s of processor time) and changed the
// last bits; with one, a bake is the same on every run.
class OneBlasThread {
 public:
  OneBlasThread() { openblas_set_num_threads(1); }
  ~OneBlasThread() { openblas_set_num_threads(before_); }
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int before_ = openblas_get_num_threads();
};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

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

// K - sigma M in K's pattern (lower triangle), which holds M's.
fem::SparseMatrix shifted_stiffness(const fem::System& system, double sigma) {
  fem::SparseMatrix shifted = system.stiffness;
  const fem::SparseMatrix& mass = system.node_mass;
  for (Eigen::Index column = 0; column < mass.cols(); ++column) {
    for (int j = 0; j < 3; ++j) {
      double* entry = shifted.valuePtr() + shifted.outerIndexPtr()[3 * column + j];
      const int* row = shifted.innerIndexPtr() + shifted.outerIndexPtr()[3 * column + j];
      for (fem::SparseMatrix::InnerIterator m(mass, column); m; ++m) {
        const auto wanted = static_cast<int>(3 * m.row() + j);
        if (m.row() < column) continue;
        while (*row != wanted) ++row, ++entry;
        *entry -= sigma * m.value();
      }
    }
  }
  return shifted;
}

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

Eigenmodes solve_dense(const fem::System& system) {
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd mass =
      fem::mass_times(system.node_mass, Eigen::MatrixXd::Identity(stiffness.rows(), stiffness.rows()));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solved(stiffness, mass);
  Eigenmodes modes;
  if (solved.info() != Eigen::Success) return modes;
  modes.lambda = solved.eigenvalues();
  modes.shapes = solved.eigenvectors();
  return modes;
}

// Rounding leaves a rigid motion with lambda of about 1e-16 of the largest eigenvalue of the mesh, which the largest
// ratio of diagonal entries estimates. The limit stays far below the band (a few Hz to 60 Hz under 20 kHz), so that a
// mesh with a few very bad elements does not make sounding modes look rigid.
double rigid_limit(const fem::System& system, double highest_lambda) {
  double stiffest = 0;
  for (Eigen::Index n = 0; n < system.node_mass.cols(); ++n) {
    const double mass = system.node_mass.coeff(n, n);
    for (int i = 0; i < 3; ++i) stiffest = std::max(stiffest, system.stiffness.coeff(3 * n + i, 3 * n + i) / mass);
  }
  const double rounding = 100 * std::numeric_limits<double>::epsilon() * stiffest;
  return std::clamp(rounding, 1e-8 * highest_lambda, 1e-5 * highest_lambda);
}

int count_rigid(const Eigen::VectorXd& lambda, double limit) {
  return static_cast<int>(std::count_if(lambda.begin(), lambda.end(), [&](double l) { return l < limit; }));
}

void keep_first(Eigenmodes& modes, Eigen::Index count) {
  modes.lambda.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
}

void find_residuals(const fem::System& system, Eigenmodes& modes) {
  modes.residuals = Eigen::VectorXd::Zero(modes.lambda.size());
  const auto stiffness = system.stiffness.selfadjointView<Eigen::Lower>();
  Eigen::VectorXd mass_shape(system.unknowns());
  for (Eigen::Index m = modes.rigid; m < modes.lambda.size(); ++m) {
    fem::apply_mass(system.node_mass, modes.shapes.col(m).data(), mass_shape.data());
    const Eigen::VectorXd error = stiffness * modes.shapes.col(m) - modes.lambda[m] * mass_shape;
    modes.residuals[m] = error.norm() / (modes.lambda[m] * mass_shape.norm());
  }
}

// Asks Spectra for more and more of the modes nearest to the shift until one is past the top.
Result<Eigenmodes> iterate(const fem::System& system, const EigenRequest& request, double sigma, double rigid_limit,
                           ShiftedInverse& inverse) {
  using Solver = Spectra::SymGEigsShiftSolver<ShiftedInverse, MassProduct, Spectra::GEigsMode::ShiftInvert>;
  MassProduct mass(system.node_mass);
  const auto unknowns = static_cast<int>(system.unknowns());
  for (int wanted = std::min(kFirstRequest, unknowns - 1);;) {
    const int basis = std::min(unknowns, 2 * wanted + 20);
    inverse.expect(basis + wanted);
    Solver solver(inverse, mass, wanted, basis, sigma);
    solver.init();
    solver.compute(Spectra::SortRule::LargestMagn, kMostRestarts, request.tolerance, Spectra::SortRule::SmallestAlge);
    if (solver.info() != Spectra::CompInfo::Successful) {
      return fail("the modes did not converge in " + std::to_string(kMostRestarts) +
                  " restarts; look for needle-like elements in the mesh");
    }
    Eigenmodes modes;
    modes.lambda = solver.eigenvalues();
    modes.rigid = count_rigid(modes.lambda, rigid_limit);
    const auto in_band = (modes.lambda.array() <= request.highest_lambda).count();
    if (in_band - modes.rigid > request.most_modes) {
      return fail("more than " + std::to_string(request.most_modes) +
                  " modes lie in the band; narrow the band or allow more modes");
    }
    if (in_band < wanted || wanted == unknowns - 1) {
      modes.shapes = solver.eigenvectors();
      return modes;
    }
    wanted = next_request(modes.lambda, modes.rigid, request.highest_lambda);
    wanted = std::min({wanted, unknowns - 1, request.most_modes + modes.rigid + 1});
  }
}

Result<Eigenmodes> solve_sparse(const fem::System& system, const EigenRequest& request, double rigid_limit,
                                const Progress& progress) {
  const double sigma = -1e-4 * request.highest_lambda;
  const double start = seconds_now();
  if (progress && !progress("factors", 0)) return fail(std::string(kCancelled));
  ShiftedInverse inverse(shifted_stiffness(system, sigma), progress);
  if (!inverse.ok()) {
    return fail("the stiffness of the mesh could not be factored (" + std::to_string(system.unknowns()) +
                " unknowns); check the mesh for flat elements, or make it coarser if memory ran out");
  }
  const double factored = seconds_now();
  Result<Eigenmodes> modes = iterate(system, request, sigma, rigid_limit, inverse);
  if (!modes) return modes;
  modes->factor_seconds = factored - start;
  modes->iterate_seconds = seconds_now() - factored;
  modes->solves = inverse.solves();
  return modes;
}

}  // namespace

Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request, const Progress& progress) {
  const OneBlasThread one_thread;
  try {
    const double limit = rigid_limit(system, request.highest_lambda);
    Result<Eigenmodes> modes =
        system.unknowns() <= kSmallProblem ? solve_dense(system) : solve_sparse(system, request, limit, progress);
    if (!modes) return modes;
    if (modes->lambda.size() == 0)
      return fail("the mass of the mesh is not positive; check the mesh for flat elements");
    keep_first(*modes, (modes->lambda.array() <= request.highest_lambda).count());
    modes->rigid = count_rigid(modes->lambda, limit);
    find_residuals(system, *modes);
    return modes;
  } catch (const Cancelled&) {
    return fail(std::string(kCancelled));
  } catch (const std::bad_alloc&) {
    return fail("not enough memory for " + std::to_string(system.unknowns()) + " unknowns; make the mesh coarser");
  } catch (const std::exception& error) {
    return fail(std::string("the eigensolver failed: ") + error.what());
  }
}

}  // namespace ringdown::bake
