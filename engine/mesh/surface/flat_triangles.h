// Removes triangles without area, and joins the edges that they hide. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// Removes the triangles whose corners lie on one line. The neighbour at the longest side of such a triangle is cut in
// two at the flat triangle's third corner, so that the edges fit together (a T-joint). Returns the number of removed
// triangles, and adds the number of visited triangles to `steps`. O(T log T).
std::size_t split_at_flats(TriangleMesh& mesh, std::size_t& steps);

}  // namespace ringdown::mesh
