// K and M, with their rows spread over the processes. [all processes together]
#pragma once

#include "engine/solve/distributed_files.h"

#include <petscmat.h>

namespace ringdown::cli {

struct Pencil {
  solve::ProblemHeader header;  // equal in every process
  Mat stiffness = nullptr;      // K / highest_lambda: the band is 0 ... 1
  Mat mass = nullptr;           // M; each entry stands for x, y and z
};

// Reads K and M: the first process reads the file and sends the others their rows, so no folder need be shared. All
// processes have about equal numbers of nodes, with the three unknowns of a node together. Gives up if the file is
// invalid.
Pencil read_pencil(const char* path);

}  // namespace ringdown::cli
