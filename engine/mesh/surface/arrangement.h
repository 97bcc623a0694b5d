// A surface cut along every line in which it meets itself. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// Triangles that have no more in common than corners and sides.
struct Arrangement {
  TriangleMesh mesh;
  // Of each triangle, how many triangles of the surface it is a part of: those that face its way, less those that face
  // the other way. At least 1: where as many face either way, nothing is kept.
  std::vector<int> layers;
};

// Cuts are found and made in exact arithmetic (CGAL's Epeck); only at the end are points rounded to double precision,
// which may move a point by 1e-16 of its coordinates. Triangles that nothing meets are kept as they are. Nodes at the
// same place must be one node, and no triangle may be without area. Fails when more than kMaxCuts pairs of triangles
// meet. O(T log T) and some 50 us for each pair.
inline constexpr std::size_t kMaxCuts = 200'000;
Result<Arrangement> arrange(const TriangleMesh& mesh);

}  // namespace ringdown::mesh
