// Where two closed surfaces of triangles touch, or will in a moment. Free of any physics engine. [any thread]
//
// A library that looks for intersections of triangles finds other points in every step, with directions that depend on
// how two triangles happen to cross, and none where bodies rest on each other without overlap. Here a contact is a pair
// of features that face each other: a corner of one body over a triangle of the other, or two edges across each other.
// Such pairs stay the same while bodies rest, and have one direction each, also at a distance.
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

// How deep features may be in each other to count at all.
struct DepthLimit {
  double standing_m = 0;                                     // of bodies that do not approach each other
  double max_m = 0;                                          // of the fastest
  std::function<double(Vec3 point, Vec3 normal)> came_in_m;  // how far they may have come into each other at a point
};

// Appends the contacts of two surfaces that are at most `margin_m` apart, in the second one's frame.
void find_surface_contacts(const Surface& first, const Surface& second, const RelativePose& pose, double margin_m,
                           const DepthLimit& limit, std::vector<SurfaceContact>& found);

}  // namespace ringdown::scene
