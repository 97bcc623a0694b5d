// ringdown-modes-slepc: the modes of a mesh that outgrows one machine. solve_modes() runs it (Method::kSlepc):
//
//   mpirun -n 8 ringdown-modes-slepc PROBLEM MODES
//
// The program reads the first file and writes the second (engine/solve/distributed_files.h). Options of PETSc and SLEPc
// may follow. From time to time it writes a line "STAGE FRACTION" to standard output; on failure one sentence to
// standard error, with exit code 1.
#include "clients/cli/slepc/failure.h"
#include "clients/cli/slepc/krylov_schur.h"

#include <cstdio>
#include <cstring>

namespace {

using namespace ringdown;
using cli::check;
using cli::give_up;

constexpr char kHelp[] =
    "Finds the modes of a problem that ringdown-bake --solver slepc wrote.\n"
    "  ringdown-modes-slepc PROBLEM MODES [-first N] [options of PETSc and SLEPc]\n"
    "  -first N: the first N modes from one factorisation, uncounted, instead of all in the band\n\n";

int rank() {
  int number = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &number);
  return number;
}

PetscErrorCode on_error(MPI_Comm, int, const char* function, const char*, PetscErrorCode code, PetscErrorType type,
                        const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) give_up(formatted("{} (in {})", message, function));
  return code;
}

void say(const char* stage, double fraction) {
  if (rank() > 0) return;
  std::printf("%s %.3f\n", stage, fraction);
  std::fflush(stdout);
}

// Every process sends its rows of each shape to the first, which writes them.
void write_result(const char* path, const cli::Pencil& pencil, const cli::Solved& solved) {
  const solve::ModesHeader header{.nodes = pencil.header.nodes,
                                  .modes = static_cast<std::int64_t>(solved.lambda.size()),
                                  .solves = solved.solves,
                                  .factorizations = solved.factorizations,
                                  .factor_seconds = solved.factor_seconds,
                                  .iterate_seconds = solved.iterate_seconds};
  Vec shape = nullptr, whole = nullptr;
  VecScatter gather = nullptr;
  check(MatCreateVecs(pencil.stiffness, &shape, nullptr));
  check(VecScatterCreateToZero(shape, &gather, &whole));
  const double* values = nullptr;
  const auto fetch = [&](std::int64_t mode) {
    check(EPSGetEigenvector(solved.solver, solved.order[mode], shape, nullptr));
    check(VecScatterBegin(gather, shape, whole, INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(gather, shape, whole, INSERT_VALUES, SCATTER_FORWARD));
    check(VecGetArrayRead(whole, &values));
    const std::span<const double> rows(values, rank() == 0 ? 3 * static_cast<std::size_t>(header.nodes) : 0);
    check(VecRestoreArrayRead(whole, &values));  // rows stay where they are until the next mode
    return rows;
  };
  if (rank() > 0) {
    for (std::int64_t m = 0; m < header.modes; ++m) fetch(m);
  } else if (auto written = solve::write_modes(path, header, solved.lambda, fetch); !written) {
    give_up(written.error().message);
  }
  check(VecScatterDestroy(&gather));
  check(VecDestroy(&whole));
  check(VecDestroy(&shape));
}

void run(const char* problem, const char* answer) {
  say("factors", 0);
  cli::Pencil pencil = cli::read_pencil(problem);
  PetscInt first = 0;
  check(PetscOptionsGetInt(nullptr, nullptr, "-first", &first, nullptr));
  const cli::SolveProgress progress = [](double fraction) { say("modes", fraction); };
  cli::Solved solved = first > 0 ? cli::solve_first(pencil, first, progress) : cli::solve_band(pencil, progress);
  write_result(answer, pencil, solved);
  check(EPSDestroy(&solved.solver));
  check(MatDestroy(&pencil.stiffness));
  check(MatDestroy(&pencil.mass));
}

}  // namespace

int main(int argc, char** argv) {
  if (SlepcInitialize(&argc, &argv, nullptr, kHelp) != 0) return 1;
  PetscPushErrorHandler(on_error, nullptr);
  PetscBool help = PETSC_FALSE;
  PetscOptionsHasHelp(nullptr, &help);
  if (!help && argc < 3) give_up("give a problem file and the file for the modes; --help says more");
  if (!help) run(argv[1], argv[2]);
  SlepcFinalize();
  return 0;
}
