// Points on triangles by their barycentric weights, which are >= 0 and sum to 1. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace ringdown {

// Barycentric weights of the point of the segment a-b nearest to the origin.
inline std::array<double, 2> nearest_on_segment(Vec3 a, Vec3 b) RINGDOWN_REALTIME {
  const Vec3 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(-dot(a, along) / squared, 0.0, 1.0) : 0.0;
  return {1 - t, t};
}

// The point with those barycentric weights.
inline Vec3 at_weights(const std::array<Vec3, 3>& v, const std::array<double, 3>& w) RINGDOWN_REALTIME {
  return w[0] * v[0] + (w[1] * v[1] + w[2] * v[2]);
}

// Barycentric weights of the point of a triangle nearest to `p`: the projection when it falls inside, else the best
// of the three edges. Degenerate triangles fall through to their edges.
inline std::array<double, 3> nearest_on_triangle(Vec3 p, const std::array<Vec3, 3>& corners) RINGDOWN_REALTIME {
  const std::array<Vec3, 3> v = {corners[0] - p, corners[1] - p, corners[2] - p};
  const Vec3 normal = cross(v[1] - v[0], v[2] - v[0]);
  const double area_squared = dot(normal, normal);
  if (area_squared > 0) {
    const std::array<double, 3> inside = {dot(cross(v[1], v[2]), normal) / area_squared,
                                          dot(cross(v[2], v[0]), normal) / area_squared,
                                          dot(cross(v[0], v[1]), normal) / area_squared};
    if (inside[0] >= 0 && inside[1] >= 0 && inside[2] >= 0) return inside;
  }
  std::array<double, 3> best{};
  double best_squared = std::numeric_limits<double>::infinity();
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const std::size_t next = (edge + 1) % 3;
    const auto weights = nearest_on_segment(v[edge], v[next]);
    std::array<double, 3> candidate{};
    candidate[edge] = weights[0];
    candidate[next] = weights[1];
    const Vec3 offset = at_weights(v, candidate);
    if (dot(offset, offset) < best_squared) {
      best_squared = dot(offset, offset);
      best = candidate;
    }
  }
  return best;
}

}  // namespace ringdown
