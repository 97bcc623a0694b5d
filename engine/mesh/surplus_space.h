// The functions of degree p + 1 (surplus_basis.h) over a whole mesh of order p: which element has which. [worker]
#pragma once

#include "engine/mesh/surplus_basis.h"
#include "engine/mesh/tet_mesh.h"

#include <vector>

namespace ringdown::mesh {

struct SurplusSpace {
  // E x n numbers of nodes, as if each element's corners were named in ascending order of their numbers: neighbours
  // then agree on the direction of their edges and faces, and no function needs a sign. Every second element turns
  // inside out that way.
  Indices nodes;
  // E x w numbers of functions, in the order of surplus_shape(). Those of all edges come first, then those of faces,
  // then the inner ones; functions of the same face or element are neighbours.
  Indices functions;
  // Where the functions of one edge, face or element begin; the last entry is the count of all functions.
  std::vector<int> parts;

  [[nodiscard]] int count() const { return parts.back(); }
};

SurplusSpace surplus_space(const TetMesh& mesh);  // O(E log E)

}  // namespace ringdown::mesh
