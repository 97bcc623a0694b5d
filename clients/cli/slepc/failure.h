// How any of the processes gives up. [any of them]
#pragma once

#include <petscsys.h>

#include <string>

namespace ringdown::cli {

// Says one sentence and ends all processes.
[[noreturn]] inline void give_up(const std::string& sentence) {
  PetscFPrintf(PETSC_COMM_SELF, stderr, "ringdown-modes-slepc: %s\n", sentence.c_str());
  MPI_Abort(PETSC_COMM_WORLD, 1);
  std::abort();
}

// Around every call of PETSc and SLEPc: their error handler, main.cpp's, has given up before one returns an error.
inline void check(PetscErrorCode code) {
  if (code != 0) give_up("PETSc's error " + std::to_string(static_cast<int>(code)));
}

}  // namespace ringdown::cli
