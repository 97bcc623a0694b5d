// A point, direction or impulse in space: three doubles, and the few operations the real-time half needs.
// The offline half uses Eigen instead. [any thread]
#pragma once

#include "engine/base/realtime.h"

#include <array>
#include <cmath>

namespace ringdown {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(Vec3 a, Vec3 b) REALTIME { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) REALTIME { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, Vec3 a) REALTIME { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) REALTIME { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) REALTIME {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) REALTIME { return std::sqrt(dot(a, a)); }
inline bool is_finite(Vec3 a) REALTIME { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

// Returns two unit vectors perpendicular to a unit vector and to each other.
inline std::array<Vec3, 2> across(Vec3 direction) REALTIME {
  const Vec3 side = cross(direction, std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Vec3 first = (1 / length(side)) * side;
  return {first, cross(direction, first)};
}

}  // namespace ringdown
