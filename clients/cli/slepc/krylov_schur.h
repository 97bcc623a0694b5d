// Modes by SLEPc's Krylov-Schur method with shift and invert. [all processes together]
#pragma once

#include "clients/cli/slepc/pencil.h"

#include <slepceps.h>

#include <functional>
#include <vector>

namespace ringdown::cli {

// Called in every process now and then with how far the iteration is, about: 0..1.
using SolveProgress = std::function<void(double fraction)>;

struct Solved {
  EPS solver = nullptr;
  std::vector<double> lambda;   // ascending; of K and M as they came, not scaled
  std::vector<PetscInt> order;  // number in `solver` of each
  int solves = 0, factorizations = 0;
  double factor_seconds = 0, iterate_seconds = 0;
};

// All modes below highest_lambda: SLEPc slices the spectrum, and by Sylvester's law of inertia knows how many lie in
// each slice. Factors by MUMPS, which works over all processes. Gives up unless as many are found as were counted, or
// when there are more than max_modes.
Solved solve_band(const Pencil& pencil, const SolveProgress& progress);

// The first `count` modes, from one factorisation, uncounted: for comparison. PETSc's own options choose what factors:
// -st_pc_factor_mat_solver_type petsc | cholmod | mumps.
Solved solve_first(const Pencil& pencil, int count, const SolveProgress& progress);

}  // namespace ringdown::cli
