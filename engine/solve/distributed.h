// Finds modes by SLEPc over MPI, with the program ringdown-modes-slepc. It runs as several processes, on several
// machines if mpirun is configured for them (by its hostfile, or by a batch system it knows). Private to engine/solve,
// and for the benchmark, which hands the program other options. [worker]
//
// Only the first process reads and writes files; they lie in a private folder below TMPDIR.
#pragma once

#include "engine/base/process/child_process.h"
#include "engine/base/progress.h"
#include "engine/solve/eigensolver.h"

#include <string>
#include <vector>

namespace ringdown::solve {

struct DistributedRun {
  int processes = 2;                 // 1: without mpirun
  std::vector<std::string> options;  // options of the program after the two file names; see ringdown-modes-slepc --help
  double limit_s = 0;                // limit of the program's wall time; 0: none
};

struct DistributedModes {
  Eigenmodes modes;  // lambda, shapes, solves, factorizations, seconds
  ChildOutcome run;
};

// Fails with one sentence when the program or mpirun is missing, or with the program's own message. Throws Cancelled.
Result<DistributedModes> run_distributed(const fem::System& system, const EigenRequest& request,
                                         const DistributedRun& run, const Progress& progress);

}  // namespace ringdown::solve
