// The part of a surface from which its mirror images make up the whole. Without CGAL, which the programs that bake do
// not link. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::radiate {

// What lies where the first `mirrors` coordinates are not negative. Nodes close to a plane are moved onto it unless the
// surface runs along the plane there; triangles that still cross it are cut. Nodes on a plane have the coordinate 0
// exactly.
mesh::TriangleMesh mirror_part_of(const mesh::TriangleMesh& surface, int mirrors);

}  // namespace ringdown::radiate
