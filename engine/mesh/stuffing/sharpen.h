// Giving a stuffed body its sharp edges back. [worker]
#pragma once

#include "engine/mesh/stuffing/winding_number.h"
#include "engine/mesh/tet_mesh.h"

namespace ringdown::mesh {

// Isosurfaces cut edges off. Where the surface's normals around a node of the skin differ by more than 35 degrees and
// their planes meet in one line or point (to a twentieth of `size_m`, the cells' edge), the node moves there, at most
// 0.8 cells far, if all angles around it stay within kMinDihedral and kMaxDihedral; else half the way. Straight
// elements, positively oriented, whose skin lies on the surface. Returns how many nodes moved. The same bits every
// time.
int sharpen(TetMesh& mesh, const WindingNumber& surface, double size_m);

}  // namespace ringdown::mesh
