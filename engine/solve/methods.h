// What the methods behind solve_modes() share, and their entry points. Private to engine/solve. [worker]
#pragma once

#include "engine/solve/eigensolver.h"

namespace ringdown::solve {

// Thrown out of an iteration when Progress says stop; solve_modes() catches it.
struct Cancelled {};

// A rigid motion has lambda = 0 to rounding; below this it is one.
using RigidLimit = double;

// Each returns at least the modes up to request.highest_lambda, ascending, M-orthonormal; lambda and shapes are filled.
// The last two prove that they are all, and fill `counted`; the last one `residuals` too.
Result<Eigenmodes> solve_dense(const fem::System& system);
Result<Eigenmodes> solve_spectra(const fem::System& system, const EigenRequest& request, RigidLimit rigid_limit,
                                 const Progress& progress);
Result<Eigenmodes> solve_slepc(const fem::System& system, const EigenRequest& request, const Progress& progress);
Result<Eigenmodes> solve_block_lanczos(const fem::System& system, const EigenRequest& request, int threads,
                                       const Progress& progress);

// Eigenvalues below, by inertia alone.
Result<int> count_modes(const fem::System& system, double highest_lambda, int threads);

// K - sigma M in K's pattern (lower triangle), which holds M's.
fem::SparseMatrix shifted_stiffness(const fem::System& system, double sigma);

int count_below(const Eigen::VectorXd& lambda, double limit);
Error too_many_modes(const EigenRequest& request);
Error not_factored(const fem::System& system);

// Steady clock [s].
double seconds_now();

}  // namespace ringdown::solve
