// Finds the faults of a surface and changes nothing. [worker]
//
//   const SurfaceReport report = diagnose(mesh);
//   for (const Finding& finding : report.findings) puts(describe(finding).c_str());
//   if (report.sound()) ...gmsh can fill it...
#pragma once

#include "engine/mesh/surface/shells.h"
#include "engine/mesh/surface/surface_report.h"

#include <array>
#include <vector>

namespace ringdown::mesh {

// Node numbers must be in range and coordinates finite. O(T log T), plus the cost of shells_of().
SurfaceReport diagnose(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

// Returns up to `max` pairs of triangles that meet in more than their shared corners, the lower number first. Exact
// (CGAL's predicates); degenerate triangles and duplicates are ignored. O(T log T) if few bounding boxes of triangles
// meet. [any thread]
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t max);

}  // namespace ringdown::mesh
