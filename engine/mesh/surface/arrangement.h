// Cuts a surface along every line in which it meets itself. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// Triangles that share nothing but corners and sides.
struct Arrangement {
  TriangleMesh mesh;
  // For each triangle, the number of the surface's triangles there that face its way, less those that face the opposite
  // way. At least 1: where the two numbers are equal, no triangle is kept.
  std::vector<int> layers;
};

// Cuts are found and made in exact arithmetic (CGAL's Epeck); only at the end are points rounded to double precision,
// which may move a point by 1e-16 of its coordinates. Triangles that meet no other are unchanged. No two nodes may have
// equal positions, and every triangle must have an area. Fails if more than kMaxCuts pairs of triangles meet.
// O(T log T) and about 50 us for each pair.
inline constexpr std::size_t kMaxCuts = 200'000;
Result<Arrangement> arrange(const TriangleMesh& mesh);

}  // namespace ringdown::mesh
