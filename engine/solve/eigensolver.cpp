#include "engine/solve/eigensolver.h"

#include "engine/base/in_parallel.h"
#include "engine/fem/blas_threads.h"
#include "engine/solve/methods.h"
#include "engine/solve/ordered_system.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

namespace ringdown::solve {
namespace {

constexpr int kSmallProblem = 300;  // unknowns; below, dense algebra is quicker and sure
constexpr int kOneThread = 3000;    // unknowns; below, threads would mostly wait for each other

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

void keep_first(Eigenmodes& modes, Eigen::Index count) {
  modes.lambda.conservativeResize(count);
  modes.shapes.conservativeResize(Eigen::NoChange, count);
  if (modes.residuals.size() > 0) modes.residuals.conservativeResize(count);
}

Eigen::VectorXd residuals_of(const fem::System& system, int threads, const Eigenmodes& modes) {
  Team team(threads);
  const Elimination plan = plan_elimination(system, threads);
  return OrderedSystem(system, plan, team).residuals(modes.lambda, modes.shapes);
}

Result<Eigenmodes> solve_by(Method method, const fem::System& system, const EigenRequest& request, double rigid_limit,
                            int threads, const Progress& progress) {
  if (method == Method::kBlockLanczos) return solve_block_lanczos(system, request, threads, progress);
  if (method == Method::kSlepc) return solve_slepc(system, request, progress);
  Result<Eigenmodes> modes =
      method == Method::kDense ? solve_dense(system) : solve_spectra(system, request, rigid_limit, progress);
  if (!modes) return modes;
  const Result<int> counted = count_modes(system, request.highest_lambda, threads);
  if (!counted) return fail(counted.error());
  modes->counted = *counted;
  const auto found = (modes->lambda.array() < request.highest_lambda).count();
  if (found == *counted) return modes;
  return fail(ErrorKind::refused,
              std::to_string(*counted) + " modes were counted and " + std::to_string(found) + " found");
}

}  // namespace

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int count_below(const Eigen::VectorXd& lambda, double limit) {
  return static_cast<int>(std::count_if(lambda.begin(), lambda.end(), [&](double l) { return l < limit; }));
}

Error too_many_modes(const EigenRequest& request) {
  return {ErrorKind::too_large, "more than " + std::to_string(request.most_modes) +
                                    " modes lie in the band; narrow the band or allow more modes"};
}

Error not_factored(const fem::System& system) {
  return {ErrorKind::bad_input,
          "the stiffness of the mesh could not be factored (" + std::to_string(system.unknowns()) +
              " unknowns); check the mesh for flat elements, or make it coarser if memory ran out"};
}

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

Result<Eigenmodes> solve_modes(const fem::System& system, const EigenRequest& request, const Progress& progress) {
  const fem::BlasThreads one(1);
  try {
    const double limit = rigid_limit(system, request.highest_lambda);
    const int threads = system.unknowns() < kOneThread ? 1 : thread_count(request.threads);
    Method method = request.method;
    if (method == Method::kAutomatic)
      method = system.unknowns() <= kSmallProblem ? Method::kDense : Method::kBlockLanczos;
    Result<Eigenmodes> modes = solve_by(method, system, request, limit, threads, progress);
    if (!modes) return modes;
    keep_first(*modes, (modes->lambda.array() < request.highest_lambda).count());
    const auto known = std::min<Eigen::Index>(request.rigid, modes->lambda.size());
    modes->rigid = request.rigid >= 0 ? static_cast<int>(known) : count_below(modes->lambda, limit);
    if (modes->lambda.size() - modes->rigid > request.most_modes) return fail(too_many_modes(request));
    if (modes->residuals.size() == 0) modes->residuals = residuals_of(system, threads, *modes);
    modes->residuals.head(modes->rigid).setZero();
    return modes;
  } catch (const Cancelled&) {
    return fail_cancelled();
  } catch (const std::bad_alloc&) {
    return fail(ErrorKind::no_memory,
                "not enough memory for " + std::to_string(system.unknowns()) + " unknowns; make the mesh coarser");
  } catch (const std::exception& error) {
    return fail(ErrorKind::refused, std::string("the eigensolver failed: ") + error.what());
  }
}

}  // namespace ringdown::solve
