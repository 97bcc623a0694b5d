// Where a surface cuts itself. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <array>
#include <vector>

namespace ringdown::mesh {

// Pairs of triangles that have more in common than their shared corners, up to `most`, the lower number first. Exact
// (CGAL's predicates); degenerate triangles and copies of others are passed over. O(T log T) where few boxes of
// triangles meet.
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t most);

}  // namespace ringdown::mesh
