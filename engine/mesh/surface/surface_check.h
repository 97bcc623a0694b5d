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

// Node numbers must be in range and coordinates finite. O(T log T), and what shells_of() takes.
SurfaceReport diagnose(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

// Where a surface cuts itself. [any thread]

// Pairs of triangles that have more in common than their shared corners, up to `most`, the lower number first. Exact
// (CGAL's predicates); degenerate triangles and copies of others are passed over. O(T log T) where few boxes of
// triangles meet.
std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t most);

}  // namespace ringdown::mesh
