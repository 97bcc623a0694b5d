// The convex hull of a surface, small enough to collide in real time. Qhull is private to the .cpp. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

struct Hull {
  std::vector<Vec3> points;                             // corners, some of the points given
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// A hull keeps at most this many corners. Collision cost grows with their number times that of the other body's.
inline constexpr std::size_t kMaxHullPoints = 128;

// The hull of `points`; where it has more than kMaxHullPoints corners, of the farthest points in that many evenly
// spread directions: an inner hull whose corners still lie on the surface. Fails when the points lie in one plane.
Result<Hull> convex_hull(std::span<const Vec3> points);

}  // namespace ringdown::scene
