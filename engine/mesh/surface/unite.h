// Bodies that run into each other become one. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// The boundary of all that the surface goes around at least once, outward: the skin of the union, whatever cuts, folds
// over or repeats itself in it. Each shell must be turned outward, and inward where it is a cavity (shells.h). Exact
// but for rounding to kMergeShare of the diagonal, to which nodes are merged; a hole stays a hole, at which inside is
// where the winding number is above one half. What touches along an edge or in a point still does (separate() in
// remesh.h). Fails when the surface cuts itself more often than kMaxCuts (arrangement.h).
Result<TriangleMesh> unite(const TriangleMesh& mesh);

inline constexpr double kMergeShare = 1e-10;  // of the diagonal

}  // namespace ringdown::mesh
