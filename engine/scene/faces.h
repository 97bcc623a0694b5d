// How two convex bodies lie on each other: over which polygon their faces touch. Free of any physics engine. [any
// thread]
//
// A collision finder that knows hulls only as sets of points (ODE's, by libccd) answers with one point, on which
// nothing can lie: a stack of such hulls totters and rattles for ever. Where faces meet, this finds the corners of what
// they share.
#pragma once

#include "engine/scene/rotation.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

// Triangles this nearly in one plane are one face; and as nearly must a face lie across the normal to be lain on.
inline constexpr double kFlat_degrees = 3;

struct Face {
  Vec3 normal;                // unit, outwards
  std::vector<Vec3> corners;  // counter-clockwise from outside
};

// The faces of a convex body, each wide enough for its triangles to be in none or one.
std::vector<Face> flat_faces(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
std::vector<Face> box_faces(Vec3 size_m);  // about its centre

// Where a body's frame lies in the world.
struct Placed {
  std::span<const Face> faces;
  Matrix3 turn;
  Vec3 place_m;
};

struct FacePoint {
  Vec3 point_m;  // world, between the two
  double depth_m = 0;
};
struct FaceContact {
  Vec3 normal;  // unit, world, into the first
  std::vector<FacePoint> points;
};

// The corners of what the two share, as far as they are in each other; none where an edge or a corner touches.
// `normal` is about where the first is to go to part from the second.
FaceContact share_of_faces(const Placed& first, const Placed& second, Vec3 normal);

}  // namespace ringdown::scene
