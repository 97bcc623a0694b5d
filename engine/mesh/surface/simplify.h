// Fewer triangles for a surface that has far more than what is made of it needs. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <cstddef>

namespace ringdown::mesh {

// Collapses edges until about `triangles` are left, those first that change the shape least, and none that would move
// the surface by more than `max_m` (M. Garland & P. S. Heckbert, Surface Simplification Using Quadric Error Metrics,
// SIGGRAPH 1997; meshoptimizer). Nodes that stay keep their places, and holes their rims. The surface may have any
// faults; where more than two triangles meet in an edge, all stay. O(T log T), about a microsecond for each triangle.
TriangleMesh simplified(const TriangleMesh& surface, std::size_t triangles, double max_m);

}  // namespace ringdown::mesh
