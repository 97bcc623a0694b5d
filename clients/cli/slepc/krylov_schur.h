// Modes by SLEPc's Krylov-Schur method with shift and invert. [all processes together]
#pragma once

#include "clients/cli/slepc/pencil.h"

#include <slepceps.h>

#include <functional>
#include <vector>

namespace ringdown::cli {

// Called in every process from time to time with the approximate progress of the iteration: 0..1.
using SolveProgress = std::function<void(double fraction)>;

struct Solved {
  EPS solver = nullptr;
  std::vector<double> lambda;   // ascending; of the original K and M, not scaled
  std::vector<PetscInt> order;  // number of each mode in `solver`
  int solves = 0, factorizations = 0;
  double factor_seconds = 0, iterate_seconds = 0;
};

// Finds all modes below highest_lambda. SLEPc slices the spectrum, and knows by Sylvester's law of inertia how many
// modes lie in each slice. Factors by MUMPS, which works over all processes. Gives up unless the counted number is
// found, or if there are more than max_modes.
Solved solve_band(const Pencil& pencil, const SolveProgress& progress);

// Finds the first `count` modes from one factorisation, without counting; for comparison. PETSc's own options choose
// the factorisation: -st_pc_factor_mat_solver_type petsc | cholmod | mumps.
Solved solve_first(const Pencil& pencil, int count, const SolveProgress& progress);

}  // namespace ringdown::cli
