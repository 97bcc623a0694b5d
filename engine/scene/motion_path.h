// A motion that is prescribed: of a kinematic body, or of a node that a file animates. [any thread]
#pragma once

#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/scene/contact_point.h"

#include <cstddef>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxPathPoses = std::size_t{1} << 18;  // of one body

struct MotionPath {
  // Poses of the body's frame in the world, `every_s` > 0 apart, the first at the scene's beginning; over and over.
  // Between them the body moves in a straight line and turns steadily. Without poses it moves at a constant velocity
  // of its centre of mass, and turns steadily.
  std::vector<Pose> poses;
  double every_s = 0;
  Vec3 velocity_m_s, spin_rad_s;
  friend bool operator==(const MotionPath&, const MotionPath&) = default;
};

// How a body whose frame began at `start`, with its centre of mass at `center_m` in that frame, moves at `time_s`: with
// the velocity that takes it to where it will be `part_s` later. Where a path begins anew it is at rest.
Motion motion_on(const MotionPath& path, const Pose& start, Vec3 center_m, double time_s, double part_s);

}  // namespace ringdown::scene
