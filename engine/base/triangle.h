// Points on triangles, given by barycentric weights, which are >= 0 and sum to 1. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace ringdown {

// The point with the barycentric weights `w`.
inline Vec3 at_weights(const std::array<Vec3, 3>& v, const std::array<double, 3>& w) REALTIME {
  return w[0] * v[0] + (w[1] * v[1] + w[2] * v[2]);
}

// Barycentric weights of the point of a triangle's edges nearest to `p`.
inline std::array<double, 3> nearest_on_edges(Vec3 p, const std::array<Vec3, 3>& corners) REALTIME {
  std::array<double, 3> best{};
  double best_squared = std::numeric_limits<double>::infinity();
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const std::size_t next = (edge + 1) % 3;
    const Vec3 along = corners[next] - corners[edge];
    const double squared = dot(along, along);
    const double t = squared > 0 ? std::clamp(dot(p - corners[edge], along) / squared, 0.0, 1.0) : 0.0;
    const Vec3 offset = corners[edge] + t * along - p;
    if (dot(offset, offset) >= best_squared) continue;
    best_squared = dot(offset, offset);
    best = {};
    best[edge] = 1 - t;
    best[next] = t;
  }
  return best;
}

// Barycentric weights of the point of a triangle nearest to `p`. The plane falls into seven regions: beyond a corner,
// beyond an edge, or over the triangle; dot products tell which, and only then is anything divided (C. Ericson,
// Real-Time Collision Detection, 2005, section 5.1.5). For a triangle so thin that rounding errors decide, the nearest
// point on the edges is returned.
inline std::array<double, 3> nearest_on_triangle(Vec3 p, const std::array<Vec3, 3>& corners) REALTIME {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double ab_a = dot(ab, ap), ac_a = dot(ac, ap);
  if (ab_a <= 0 && ac_a <= 0) return {1, 0, 0};
  const double ab_b = dot(ab, bp), ac_b = dot(ac, bp);
  if (ab_b >= 0 && ac_b <= ab_b) return {0, 1, 0};
  const double ab_c = dot(ab, cp), ac_c = dot(ac, cp);
  if (ac_c >= 0 && ab_c <= ac_c) return {0, 0, 1};

  // The products of the whole triangle's normal with those of p's triangles on each edge; they sum to the normal's
  // square.
  const double over_c = ab_a * ac_b - ab_b * ac_a;
  if (over_c <= 0 && ab_a > 0 && ab_b < 0) {
    const double t = ab_a / (ab_a - ab_b);
    return {1 - t, t, 0};
  }
  const double over_b = ab_c * ac_a - ab_a * ac_c;
  if (over_b <= 0 && ac_a > 0 && ac_c < 0) {
    const double t = ac_a / (ac_a - ac_c);
    return {1 - t, 0, t};
  }
  const double over_a = ab_b * ac_c - ab_c * ac_b, from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (over_a <= 0 && from_b > 0 && from_c > 0) {
    const double t = from_b / (from_b + from_c);
    return {0, 1 - t, t};
  }
  const double sum = over_a + over_b + over_c;
  const Vec3 normal = cross(ab, ac);
  if (std::abs(sum - dot(normal, normal)) < 1e-3 * sum) return {over_a / sum, over_b / sum, over_c / sum};
  return nearest_on_edges(p, corners);
}

}  // namespace ringdown
