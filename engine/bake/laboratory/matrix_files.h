// Writes a body's matrices as Matrix Market files, which scipy, Matlab and Julia read. [worker]
//
//   PREFIX-K.mtx      stiffness [N/m], 3N x 3N, symmetric: its lower triangle
//   PREFIX-M.mtx      mass [kg], 3N x 3N, symmetric, with the masses that are glued on
//   PREFIX-H.mtx      what springs of supports add to K; written if there are any
//   PREFIX-nodes.csv  for each node: x_m, y_m, z_m, and moves: 0 where it is clamped
//
// Row 3 n + i is the motion of node n (from 0) along axis i. The modes of the bank solve (K + H) phi = lambda M phi on
// the rows of the nodes that move.
#pragma once

#include "engine/bake/bake.h"
#include "engine/base/result.h"

#include <string>

namespace ringdown::bake {

// `body` was solved with options.equations. Numbers have as many digits as they need to be read back exactly.
Result<void> write_matrices(const SolvedBody& body, const std::string& prefix);

}  // namespace ringdown::bake
