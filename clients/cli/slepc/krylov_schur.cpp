#include "clients/cli/slepc/krylov_schur.h"

#include "clients/cli/slepc/failure.h"

#include <algorithm>
#include <numeric>

namespace ringdown::cli {
namespace {

// K is singular, so the lowest shift lies a little below zero (in units of the band's top), as solve_modes() has it.
constexpr double kBelowZero = -1e-4;

struct Watch {
  const ModeProgress& progress;
  int expected = 0;
};

PetscErrorCode tell(EPS, PetscInt, PetscInt found, PetscScalar*, PetscScalar*, PetscReal*, PetscInt, void* context) {
  const Watch& watch = *static_cast<Watch*>(context);
  watch.progress(static_cast<int>(found), watch.expected);
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
  check(EPSSetTolerances(solver, pencil.header.tolerance, PETSC_DEFAULT));
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
  give_up("this PETSc has no MUMPS, which counts the modes of a band");
#endif
}

int total_solves(EPS solver) {
  ST shift = nullptr;
  KSP solve = nullptr;
  PetscInt count = 0;
  check(EPSGetST(solver, &shift));
  check(STGetKSP(shift, &solve));
  check(KSPGetTotalIterations(solve, &count));
  return static_cast<int>(count);
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

void iterate(EPS solver, Solved& solved) {
  const double start = MPI_Wtime();
  check(EPSSolve(solver));
  solved.iterate_seconds = MPI_Wtime() - start;
  solved.solves = total_solves(solver);
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

Solved solve_band(const Pencil& pencil, const ModeProgress& progress) {
  EPS solver = new_solver(pencil);
  factor_by_mumps(solver);
  check(EPSSetWhichEigenpairs(solver, EPS_ALL));
  check(EPSSetInterval(solver, kBelowZero, 1));
  Watch watch{progress};
  check(EPSMonitorSet(solver, tell, &watch, nullptr));
  Solved solved;
  set_up(solver, solved);
  watch.expected = inertia_of(solver).counted;
  if (watch.expected > pencil.header.most_modes) {
    give_up(std::to_string(watch.expected) + " modes lie in the band; narrow the band or allow more modes");
  }
  iterate(solver, solved);
  const Inertia inertia = inertia_of(solver);
  solved.factorizations = inertia.shifts;
  take_values(pencil, solved);
  if (static_cast<int>(solved.lambda.size()) != inertia.counted) {
    give_up("found " + std::to_string(solved.lambda.size()) + " of " + std::to_string(inertia.counted) +
            " modes in the band");
  }
  return solved;
}

Solved solve_first(const Pencil& pencil, int count, const ModeProgress& progress) {
  EPS solver = new_solver(pencil);
  check(EPSSetDimensions(solver, count, PETSC_DEFAULT, PETSC_DEFAULT));
  check(EPSSetWhichEigenpairs(solver, EPS_TARGET_MAGNITUDE));
  check(EPSSetTarget(solver, kBelowZero));
  Watch watch{progress, count};
  check(EPSMonitorSet(solver, tell, &watch, nullptr));
  Solved solved;
  set_up(solver, solved);
  iterate(solver, solved);
  solved.factorizations = 1;
  take_values(pencil, solved);
  return solved;
}

}  // namespace ringdown::cli
