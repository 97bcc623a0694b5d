#include "clients/cli/slepc/krylov_schur.h"

#include "clients/cli/slepc/failure.h"

#include <algorithm>
#include <numeric>

namespace ringdown::cli {
namespace {

// K is singular, so the lowest shift lies a little below zero (in units of the band's top), as solve_modes() has it.
constexpr double kBelowZero = -1e-4;
// SLEPc iterates to this part of the requested tolerance. A single-vector Krylov method finds the sixth rigid motion
// late, out of rounding errors: at the requested 1e-9 it accepted a copy with a residual of 4e-6 in ten of 25 runs, at
// 1e-11 the largest of 40 runs is 5e-9.
constexpr double kTolerancePart = 1e-2;
constexpr int kSolvesPerMode = 3;  // about, for the progress shown

// Counts solves, the one thing that both ways of solving tell as they go on.
struct Watch {
  const SolveProgress& progress;
  int solves = 0, expected = 0;
};

PetscErrorCode count_solve(KSP, Vec, Vec, void* context) {
  Watch& watch = *static_cast<Watch*>(context);
  if (++watch.solves % 8 == 0) watch.progress(std::min(0.99, static_cast<double>(watch.solves) / watch.expected));
  return 0;
}

// K phi = lambda M phi, both symmetric, M positive; solves through a symmetric factorisation.
EPS new_solver(const Pencil& pencil) {
  EPS solver = nullptr;
  ST shift = nullptr;
  KSP solve = nullptr;
  PC factors = nullptr;
  check(EPSCreate(PETSC_COMM_WORLD, &solver));
  check(EPSSetOperators(solver, pencil.stiffness, pencil.mass));
  check(EPSSetProblemType(solver, EPS_GHEP));
  check(EPSSetType(solver, EPSKRYLOVSCHUR));
  check(EPSSetTolerances(solver, kTolerancePart * pencil.header.tolerance, PETSC_DEFAULT));
  check(EPSGetST(solver, &shift));
  check(STSetType(shift, STSINVERT));
  check(STSetMatStructure(shift, SUBSET_NONZERO_PATTERN));
  check(STGetKSP(shift, &solve));
  check(KSPSetType(solve, KSPPREONLY));
  check(KSPGetPC(solve, &factors));
  check(PCSetType(factors, PCCHOLESKY));
  return solver;
}

// MUMPS tells the inertia only when it factors the last front itself, without ScaLAPACK (its guide, ICNTL(13)).
void factor_by_mumps(EPS solver) {
#if defined(PETSC_HAVE_MUMPS)
  ST shift = nullptr;
  KSP solve = nullptr;
  PC factors = nullptr;
  check(EPSGetST(solver, &shift));
  check(STGetKSP(shift, &solve));
  check(KSPGetPC(solve, &factors));
  check(PCFactorSetMatSolverType(factors, MATSOLVERMUMPS));
  check(PetscOptionsInsertString(nullptr, "-st_mat_mumps_icntl_13 1"));
#else
  static_cast<void>(solver);
  give_up("this PETSc has no MUMPS, which is needed to count the modes of a band");
#endif
}

struct Inertia {
  int counted = 0;  // eigenvalues between the ends
  int shifts = 0;
};

Inertia inertia_of(EPS solver) {
  PetscInt count = 0;
  PetscReal* shifts = nullptr;
  PetscInt* inertias = nullptr;
  check(EPSKrylovSchurGetInertias(solver, &count, &shifts, &inertias));
  const Inertia found{count > 0 ? static_cast<int>(inertias[count - 1] - inertias[0]) : 0, static_cast<int>(count)};
  check(PetscFree(shifts));
  check(PetscFree(inertias));
  return found;
}

// Gets all of them; SLEPc waits until one is requested.
void compute_shapes(EPS solver) {
  PetscInt count = 0;
  Mat stiffness = nullptr;
  Vec shape = nullptr;
  check(EPSGetConverged(solver, &count));
  if (count == 0) return;
  check(EPSGetOperators(solver, &stiffness, nullptr));
  check(MatCreateVecs(stiffness, &shape, nullptr));
  check(EPSGetEigenvector(solver, 0, shape, nullptr));
  check(VecDestroy(&shape));
}

// `solve` is the solver's own, which for slices of the spectrum is not that of its ST.
void iterate(EPS solver, KSP solve, int expected_modes, const SolveProgress& progress, Solved& solved) {
  Watch watch{progress, 0, kSolvesPerMode * std::max(20, expected_modes)};
  check(KSPSetPostSolve(solve, count_solve, &watch));
  const double start = MPI_Wtime();
  check(EPSSolve(solver));
  compute_shapes(solver);
  solved.iterate_seconds = MPI_Wtime() - start;
  check(KSPSetPostSolve(solve, nullptr, nullptr));
  solved.solves = watch.solves;
  EPSConvergedReason reason = EPS_CONVERGED_ITERATING;
  check(EPSGetConvergedReason(solver, &reason));
  if (reason < 0) give_up("the modes did not converge; look for needle-like elements in the mesh");
}

void set_up(EPS solver, Solved& solved) {
  const double start = MPI_Wtime();
  check(EPSSetFromOptions(solver));
  check(EPSSetUp(solver));
  solved.solver = solver;
  solved.factor_seconds = MPI_Wtime() - start;
}

void take_values(const Pencil& pencil, Solved& solved) {
  PetscInt count = 0;
  check(EPSGetConverged(solved.solver, &count));
  std::vector<double> values(static_cast<std::size_t>(count));
  for (PetscInt m = 0; m < count; ++m) check(EPSGetEigenvalue(solved.solver, m, &values[m], nullptr));
  solved.order.resize(values.size());
  std::iota(solved.order.begin(), solved.order.end(), 0);
  std::stable_sort(solved.order.begin(), solved.order.end(), [&](auto a, auto b) { return values[a] < values[b]; });
  for (const PetscInt m : solved.order) solved.lambda.push_back(values[m] * pencil.header.highest_lambda);
}

}  // namespace

Solved solve_band(const Pencil& pencil, const SolveProgress& progress) {
  EPS solver = new_solver(pencil);
  factor_by_mumps(solver);
  check(EPSSetWhichEigenpairs(solver, EPS_ALL));
  check(EPSSetInterval(solver, kBelowZero, 1));
  Solved solved;
  set_up(solver, solved);
  const int expected = inertia_of(solver).counted;
  if (expected > pencil.header.max_modes) {
    give_up(formatted("{} modes lie in the band; narrow the band or allow more modes", expected));
  }
  KSP solve = nullptr;
  check(EPSKrylovSchurGetKSP(solver, &solve));
  iterate(solver, solve, expected, progress, solved);
  const Inertia inertia = inertia_of(solver);
  solved.factorizations = inertia.shifts;
  take_values(pencil, solved);
  if (static_cast<int>(solved.lambda.size()) != inertia.counted) {
    give_up(formatted("found {} of {} modes in the band", solved.lambda.size(), inertia.counted));
  }
  return solved;
}

Solved solve_first(const Pencil& pencil, int count, const SolveProgress& progress) {
  EPS solver = new_solver(pencil);
  check(EPSSetDimensions(solver, count, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSetWhichEigenpairs(solver, EPS_TARGET_MAGNITUDE));
  check(EPSSetTarget(solver, kBelowZero));
  Solved solved;
  set_up(solver, solved);
  ST shift = nullptr;
  KSP solve = nullptr;
  check(EPSGetST(solver, &shift));
  check(STGetKSP(shift, &solve));
  iterate(solver, solve, count, progress, solved);
  solved.factorizations = 1;
  take_values(pencil, solved);
  return solved;
}

}  // namespace ringdown::cli
