// Finds where two closed surfaces of triangles touch, or nearly touch. Free of any physics engine. [any thread]
//
// Libraries that intersect triangles find different points in every step, with directions that depend on how two
// triangles happen to cross, and find none if bodies rest on each other without overlap. Here a contact is a pair of
// features that face each other: a corner of one body over a triangle of the other, or two edges across each other.
// Such pairs persist while bodies rest, and each has one direction, even at a distance.
#pragma once

#include "engine/scene/rotation.h"
#include "engine/scene/surface.h"

#include <functional>
#include <vector>

namespace ringdown::scene {

struct SurfaceContact {
  Vec3 point;          // on the second body's surface
  Vec3 normal;         // unit, out of the second body, into the first
  double depth_m = 0;  // below 0: the distance
};

// The pose of the first surface in the frame of the second.
struct RelativePose {
  Matrix3 rotation;
  Vec3 position;
};

// Deepest overlap at which a pair of features still counts as a contact.
struct DepthLimit {
  double standing_m = 0;                                     // limit for bodies that do not approach each other
  double max_m = 0;                                          // limit for the fastest bodies
  std::function<double(Vec3 point, Vec3 normal)> came_in_m;  // distance by which the bodies may have moved into each
                                                             // other at a point
};

// Appends the contacts of two surfaces that are at most `margin_m` apart, in the second one's frame.
void find_surface_contacts(const Surface& first, const Surface& second, const RelativePose& pose, double margin_m,
                           const DepthLimit& limit, std::vector<SurfaceContact>& found);

}  // namespace ringdown::scene
