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
  std::vector<Vec3> points;                             // corners, a subset of the given points
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise from outside
};

// Maximum number of corners of a hull. The cost of a collision grows with the product of both hulls' corner counts.
inline constexpr std::size_t kMaxHullPoints = 128;

// Computes the hull of `points`. If it would have more than kMaxHullPoints corners, keeps the farthest points in that
// many evenly spread directions, whose hull lies within the full one. Fails if the points lie in one plane, or if a
// point is farther than 1e9 m from the origin.
Result<Hull> convex_hull(std::span<const Vec3> points);

}  // namespace ringdown::scene
