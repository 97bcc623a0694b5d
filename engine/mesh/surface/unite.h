// Unites bodies that run into each other. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// Returns the skin of the union, turned outward: the boundary of the space that the surface encloses at least once,
// whatever cuts, folds or repetitions the surface has. Each shell must be turned outward, cavities inward (shells.h).
// Exact up to kMergeShare of the diagonal, within which nodes are merged. Holes stay; there, inside is where the
// winding number is above one half. Parts that touch along an edge or in a point still do (see separate() in remesh.h).
// Fails if the surface cuts itself more often than kMaxCuts (arrangement.h).
Result<TriangleMesh> unite(const TriangleMesh& mesh);

inline constexpr double kMergeShare = 1e-10;  // share of the diagonal

}  // namespace ringdown::mesh
