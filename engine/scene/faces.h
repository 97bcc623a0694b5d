// The polygon over which the faces of two convex bodies touch. Free of any physics engine. [any thread]
//
// A collision library that knows hulls only as sets of points (libccd, which ODE uses) finds a single contact point, on
// which no body can rest: a stack of such hulls wobbles and rattles for ever. If two faces lie on each other, the
// functions here find the corners of the polygon that they share.
#pragma once

#include "engine/scene/rotation.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

// Triangles whose planes differ by at most this angle form one face; a face can carry a body if its normal differs from
// the contact normal by at most this angle.
inline constexpr double kFlat_degrees = 3;

struct Face {
  Vec3 normal;                // unit, outwards
  std::vector<Vec3> corners;  // counter-clockwise from outside
};

// The faces of a convex body; every triangle belongs to one face or to none.
std::vector<Face> flat_faces(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles);
std::vector<Face> box_faces(Vec3 size_m);  // centred at the origin

// The faces of a body, and the pose of the body's frame in the world.
struct PosedFaces {
  std::span<const Face> faces;
  Matrix3 rotation;
  Vec3 position_m;
};

struct FacePoint {
  Vec3 point_m;  // world, halfway between the two faces
  double depth_m = 0;
};
struct FaceContact {
  Vec3 normal;  // unit, world, into the first body
  std::vector<FacePoint> points;
};

// Finds the corners of the polygon that a face of each body shares, as far as the bodies overlap there. There are none
// if an edge or a corner touches. `normal` is the approximate direction in which the first body leaves the second.
FaceContact share_of_faces(const PosedFaces& first, const PosedFaces& second, Vec3 normal);

}  // namespace ringdown::scene
