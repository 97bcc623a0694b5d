// Which nodes of a mesh share an element: the pattern of its matrices. Private to engine/fem. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <vector>

namespace ringdown::fem {

// Node n shares an element with neighbors[first[n]] ... neighbors[first[n+1] - 1], ascending; it is among them itself,
// at own[n].
struct NodeGraph {
  std::vector<int> first, own, neighbors;

  [[nodiscard]] int node_count() const { return static_cast<int>(own.size()); }
};

NodeGraph node_graph(const mesh::TetMesh& mesh, int threads);

}  // namespace ringdown::fem
