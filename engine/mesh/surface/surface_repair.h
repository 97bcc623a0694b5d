// Mending of surfaces, where there is one likely way to. [worker]
//
// In this order: coordinates that rounding has set apart become one; pairs of triangles back to back go (a wall
// inside), then copies of triangles; triangles whose corners lie in one line go, and the neighbour at their longest
// side is cut there (a T-joint); fins (triangles that hang on a crowded edge by one side and are free at another) go;
// triangles turned against their neighbours are turned; holes are closed: flat ones of any size, others of at most
// kMaxHole of the body's diagonal around; surfaces that run together at a point or an edge are taken apart; open scraps
// beside a closed body go; each shell is turned outward, cavities inward (shells.h); noise that has folded a scan is
// smoothed (denoise.h); what runs into each other, cuts itself or lies in another body is united (unite.h).
//
// Larger holes stay, and what still cuts itself: stuffing.h makes a body of such a surface.
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
  std::size_t steps = 0;              // triangles, edges and nodes visited: the measure of its cost
  std::optional<TriangleMesh> rough;  // before noise was smoothed away; none: it was not
};

// Node numbers must be in range and coordinates finite. Never fails: what it cannot mend stays as it is. O(T log T),
// and for each hole of n edges what its triangulation costs: O(n^3) at the most up to kMaxExactHole edges (remesh.h),
// about O(n log n) beyond.
RepairedSurface repair(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

// Repaired where it is not sound, and looked at before and after.
PreparedSurface prepare(const TriangleMesh& mesh, CavityRule rule = CavityRule::kWoundTheOtherWay);

}  // namespace ringdown::mesh
