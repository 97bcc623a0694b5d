// Flat triangles that leave openings as wide as the curved faces for which they stand. [any thread]
#pragma once

#include "engine/mesh/boundary.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::bake {

// Flat triangles between nodes on curved faces narrow a neck: twelve around it take 4 % of its area. Moves nodes along
// their normals by the mean distance of the curved faces from the triangles around them. Nodes on edges stay.
//
// `skin` is that of `mesh`, and `surface` is in its unit: the skin's triangles, or what is left of them above a liquid.
// Nodes of `surface` that are not where a node of the skin is, such as those on a liquid's level, stay.
void keep_openings(const mesh::TetMesh& mesh, const mesh::Boundary& skin, mesh::TriangleMesh& surface);

}  // namespace ringdown::bake
