// The skin of a solid, and a coarser one on some of the same points. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::mesh {

// Triangles between nodes of a TetMesh.
struct Boundary {
  std::vector<std::int32_t> nodes;                      // P numbers of nodes in the TetMesh, ascending
  std::vector<std::array<std::uint32_t, 3>> triangles;  // positions in `nodes`, counter-clockwise from outside
};

// The faces that belong to one element only, turned outward. A face of an element of order p becomes p^2 flat triangles
// between all its nodes, so that a coarse mesh of high order has as many points as its shapes need.
Boundary boundary_of(const TetMesh& mesh);

// At most `most_points` (>= 4) of the surface's own points, spread so that its form is kept: edges are
// collapsed onto existing points (meshoptimizer; Garland & Heckbert 1997), so whatever was computed at a kept
// point stays exact. Unchanged when it is small enough already. Fails when the skin cannot be made so small
// (thousands of pieces).
Result<Boundary> decimate(const Boundary& surface, const Points& nodes, std::size_t most_points);

// P weights that sum to 1: a third of the area of the triangles around each point, over the whole area.
std::vector<double> area_weights(const Boundary& surface, const Points& nodes);

}  // namespace ringdown::mesh
