// Functions by which a process of ringdown-modes-slepc gives up. [every process]
#pragma once

#include "engine/base/formatted.h"

#include <petscsys.h>

#include <string>

namespace ringdown::cli {

// Prints one sentence and ends all processes.
[[noreturn]] inline void give_up(const std::string& sentence) {
  PetscFPrintf(PETSC_COMM_SELF, stderr, "ringdown-modes-slepc: %s\n", sentence.c_str());
  MPI_Abort(PETSC_COMM_WORLD, 1);
  std::abort();
}

// Wraps every call of PETSc and SLEPc. Their error handler, in main.cpp, gives up before a call returns an error.
inline void check(PetscErrorCode code) {
  if (code != 0) give_up(formatted("PETSc's error {}", static_cast<int>(code)));
}

}  // namespace ringdown::cli
