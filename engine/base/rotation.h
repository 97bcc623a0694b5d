// Rotations as quaternions and matrices, and poses. [any thread]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <array>
#include <cmath>

namespace ringdown {

// A unit quaternion. It is not an aggregate: glTF, banks and our own files write x y z w, while OSC, the C library and
// ODE write w x y z, so code that makes a rotation from four numbers must name their order.
struct Rotation {
  double x = 0, y = 0, z = 0, w = 1;

  constexpr Rotation() = default;
  static constexpr Rotation from_xyzw(double x, double y, double z, double w) REALTIME {
    Rotation made;
    made.x = x;
    made.y = y;
    made.z = z;
    made.w = w;
    return made;
  }
  static constexpr Rotation from_xyzw(const std::array<double, 4>& q) REALTIME {
    return from_xyzw(q[0], q[1], q[2], q[3]);
  }
  static constexpr Rotation from_wxyz(double w, double x, double y, double z) REALTIME { return from_xyzw(x, y, z, w); }
  friend bool operator==(const Rotation&, const Rotation&) = default;
};

// The place of one frame of axes in another: a point p of the inner frame lies at position_m + rotation p.
struct Pose {
  Vec3 position_m;
  Rotation rotation;
  friend bool operator==(const Pose&, const Pose&) = default;
};

// Row-major 3 x 3; column i is the image of axis i.
using Matrix3 = std::array<std::array<double, 3>, 3>;

inline Matrix3 to_matrix(const Rotation& q) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

inline Vec3 operator*(const Matrix3& m, Vec3 v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

inline Matrix3 product(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

// The inverse of a rotation matrix.
inline Matrix3 transpose(const Matrix3& m) {
  return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}

// The inverse of a regular symmetric matrix, by its adjugate.
inline Matrix3 inverse(const Matrix3& m) {
  const Vec3 x{m[0][0], m[0][1], m[0][2]}, y{m[1][0], m[1][1], m[1][2]}, z{m[2][0], m[2][1], m[2][2]};
  const Vec3 yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  const double k = 1 / dot(x, yz);
  return {{{k * yz.x, k * yz.y, k * yz.z}, {k * zx.x, k * zx.y, k * zx.z}, {k * xy.x, k * xy.y, k * xy.z}}};
}

inline double norm(const Rotation& q) REALTIME { return std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w); }

// Returns the quaternion scaled to unit norm; its norm must not be zero.
inline Rotation normalized(const Rotation& q) REALTIME {
  const double scale = 1 / norm(q);
  return Rotation::from_xyzw(q.x * scale, q.y * scale, q.z * scale, q.w * scale);
}

// The rotation by b, followed by a.
inline Rotation operator*(const Rotation& a, const Rotation& b) REALTIME {
  return Rotation::from_xyzw(
      a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
      a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
}

// The rotation by `angle_rad` about `axis`, which may have any length but zero.
inline Rotation about(Vec3 axis, double angle_rad) {
  const double s = std::sin(angle_rad / 2) / length(axis);
  return Rotation::from_xyzw(s * axis.x, s * axis.y, s * axis.z, std::cos(angle_rad / 2));
}

// The inverse of a unit quaternion.
inline Rotation inverse(const Rotation& q) REALTIME { return Rotation::from_xyzw(-q.x, -q.y, -q.z, q.w); }

// Returns the vector rotated by a unit quaternion.
inline Vec3 rotated(const Rotation& q, Vec3 v) REALTIME {
  const Vec3 axis{q.x, q.y, q.z}, twice = 2.0 * cross(axis, v);
  return v + q.w * twice + cross(axis, twice);
}

// Convert between rotations and rotation vectors, which have the direction of the axis and the length of the angle
// [rad]. to_rotation_vector() returns the shorter way round, at most pi.
inline Rotation from_rotation_vector(Vec3 v) REALTIME {
  const double angle = length(v), half = 0.5 * angle;
  const double scale = angle > 1e-9 ? std::sin(half) / angle : 0.5;
  return Rotation::from_xyzw(scale * v.x, scale * v.y, scale * v.z, std::cos(half));
}
inline Vec3 to_rotation_vector(const Rotation& q) REALTIME {
  const double sine = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z), sign = q.w < 0 ? -1 : 1;
  const double scale = sine > 1e-12 ? 2 * std::atan2(sine, sign * q.w) / sine : 2.0;
  return sign * scale * Vec3{q.x, q.y, q.z};
}

}  // namespace ringdown
