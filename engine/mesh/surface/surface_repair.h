// Repairs faults of surfaces that have one likely repair. [worker]
//
// Repairs are made in this order:
//   - nearly equal coordinates, set apart by rounding, become equal;
//   - pairs of triangles back to back (a wall inside the body) are removed, then duplicate triangles;
//   - triangles whose corners lie on one line are removed, and the neighbour at their longest side is cut (a T-joint);
//   - fins (triangles with one side on a crowded edge and another side free) are removed;
//   - triangles turned against their neighbours are turned;
//   - holes are closed: flat ones of any size, others up to a perimeter of kMaxHole of the body's diagonal;
//   - surfaces that run together at a point or an edge are taken apart;
//   - open scraps beside a closed body are removed;
//   - each shell is turned outward, cavities inward (shells.h);
//   - noise that has folded a scan is smoothed (denoise.h);
//   - shells that run into each other, cut themselves or lie in another body are united (unite.h).
//
// Larger holes and remaining cuts stay; stuffing.h makes a body of such a surface.
#pragma once

#include "engine/mesh/surface/shells.h"
#include "engine/mesh/surface/surface_report.h"

#include <optional>
#include <string>
#include <vector>

namespace ringdown::mesh {

inline constexpr double kMaxHole = 1.0;

struct RepairedSurface {
  TriangleMesh mesh;
  std::vector<std::string> actions;   // "closed 2 holes"; empty: nothing was to be done
  std::size_t steps = 0;              // number of visited triangles, edges and nodes, a measure of the cost
  std::optional<TriangleMesh> rough;  // the surface before noise was smoothed; none: nothing was smoothed
};

// Node numbers must be in range and coordinates finite. Never fails: faults that cannot be repaired stay. O(T log T),
// plus for each hole of n edges the cost of its triangulation: at most O(n^3) up to kMaxExactHole edges (remesh.h),
// about O(n log n) beyond.
RepairedSurface repair(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

// Diagnoses the surface, repairs it if it is not sound, and diagnoses the result.
PreparedSurface prepare(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

}  // namespace ringdown::mesh
