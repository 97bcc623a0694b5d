// Cuts a surface along its mirror planes. (CGAL could clip it, but the programs that bake do not link it.) [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::radiate {

// Returns the part of the surface where the first `mirrors` coordinates are not negative. These coordinates are zero at
// the surface's middle. Nodes close to a plane are moved onto it, unless the surface runs along the plane there, and
// triangles that still cross it are cut. Nodes on a plane have the coordinate 0 exactly.
mesh::TriangleMesh mirror_part_of(const mesh::TriangleMesh& surface, int mirrors);

}  // namespace ringdown::radiate
