// How well-shaped the elements of a mesh are. [any thread]
#pragma once

#include "engine/mesh/tet_mesh.h"

namespace ringdown::mesh {

struct TetQuality {
  double smallest_angle_deg = 180, largest_angle_deg = 0;  // dihedral; a regular tetrahedron's are 70.5
  double shortest_edge_m = 0, longest_edge_m = 0;
};

// Of the straight elements between the corners. O(E).
TetQuality quality_of(const TetMesh& mesh);

}  // namespace ringdown::mesh
