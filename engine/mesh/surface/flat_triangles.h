// Triangles without area, and the edges that they hide. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// Takes out the triangles whose corners lie in one line. The neighbour at the longest side of such a triangle is cut in
// two at its third corner, so that the edges which the triangle joined fit together (a T-joint). Returns how many
// triangles were taken out; `steps` is raised by the number of triangles visited. O(T log T).
std::size_t split_at_flats(TriangleMesh& mesh, std::size_t& steps);

}  // namespace ringdown::mesh
