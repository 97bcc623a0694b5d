// Modes by SLEPc over MPI: the program ringdown-modes-slepc, run as several processes, on several machines where
// mpirun is told to (its hostfile, or a batch system it knows). Private to engine/solve, and for the benchmark, which
// hands the program other options. [worker]
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
  std::vector<std::string> options;  // of the program, after the names of the two files; ringdown-modes-slepc --help
  double limit_s = 0;                // wall time of the program; 0: none
};

struct DistributedModes {
  Eigenmodes modes;  // lambda, shapes, solves, factorizations, seconds
  ChildOutcome run;
};

// Fails with one sentence: the program or mpirun is not there, or what the program said. Throws Cancelled.
Result<DistributedModes> run_distributed(const fem::System& system, const EigenRequest& request,
                                         const DistributedRun& run, const Progress& progress);

}  // namespace ringdown::solve
