// The convex hull of a surface, small enough to collide in real time. Only hull.cpp includes Qhull. [worker]
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

// The most corners of a hull. The cost of a collision grows with the product of both hulls' corners.
inline constexpr std::size_t kMaxHullPoints = 128;

// The hull of `points`. Where it would have more than kMaxHullPoints corners, the hull of the farthest points in that
// many evenly spread directions instead, which lies within the full hull. Fails when the points lie in one plane, or
// one of them farther than 1e9 m from the origin.
Result<Hull> convex_hull(std::span<const Vec3> points);

}  // namespace ringdown::scene
