// Reduces the triangles of a surface that has far more than its use needs. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <cstddef>

namespace ringdown::mesh {

// Collapses edges until about `triangles` triangles are left. Edges that change the shape least are collapsed first,
// and none that would move the surface by more than `max_m` (M. Garland & P. S. Heckbert, Surface Simplification Using
// Quadric Error Metrics, SIGGRAPH 1997; meshoptimizer). Remaining nodes do not move, and holes keep their rims. The
// surface may have any faults; triangles at an edge with more than two triangles stay. O(T log T), about a microsecond
// for each triangle.
TriangleMesh simplified(const TriangleMesh& surface, std::size_t triangles, double max_m);

}  // namespace ringdown::mesh
