// K and M, their rows spread over the processes. [all processes together]
#pragma once

#include "engine/solve/distributed_files.h"

#include <petscmat.h>

namespace ringdown::cli {

struct Pencil {
  solve::ProblemHeader header;  // the same in every process
  Mat stiffness = nullptr;      // K / highest_lambda: the band is 0 ... 1
  Mat mass = nullptr;           // M, whose every entry stands for x, y and z
};

// The first process reads the file and sends the others their rows, so no folder need be shared. Each process has about
// as many nodes as the others, with the three unknowns of a node together. Gives up when the file is not a good one.
Pencil read_pencil(const char* path);

}  // namespace ringdown::cli
