// Restores the sharp edges of a stuffed body. [worker]
#pragma once

#include "engine/mesh/stuffing/winding_number.h"
#include "engine/mesh/tet_mesh.h"

namespace ringdown::mesh {

// Moves nodes of the skin onto sharp edges, which isosurface stuffing cuts off. If the surface's normals around a node
// differ by more than 35 degrees and their planes meet in one line or point (to a twentieth of `size_m`, the cells'
// edge), the node moves there, at most 0.8 cells far; only half the way if an angle around it would leave the range
// from kMinDihedral to kMaxDihedral. The elements must be straight and positively oriented, with the skin on the
// surface. Returns the number of moved nodes. The result is deterministic.
int sharpen(TetMesh& mesh, const WindingNumber& surface, double size_m);

}  // namespace ringdown::mesh
