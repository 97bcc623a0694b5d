// A prescribed motion of a kinematic body, or of a node that a file animates. [any thread]
#pragma once

#include "engine/base/rotation.h"
#include "engine/base/vec3.h"
#include "engine/scene/contact_point.h"

#include <cstddef>
#include <vector>

namespace ringdown::scene {

inline constexpr std::size_t kMaxPathPoses = std::size_t{1} << 18;  // poses of one body

struct MotionPath {
  // Poses of the body's frame in the world at intervals of `every_s` > 0, the first at the scene's beginning, repeated
  // for ever, or `once`: the body then stays at the last. Between two poses the body moves in a straight line and turns
  // steadily. Without poses the centre of mass moves at a constant velocity and the body turns steadily.
  std::vector<Pose> poses;
  double every_s = 0;
  bool once = false;
  Vec3 velocity_m_s, spin_rad_s;
  friend bool operator==(const MotionPath&, const MotionPath&) = default;
};

// Returns the motion at `time_s` of a body whose frame began at `start`, with its centre of mass at `center_m` in that
// frame. Its velocity takes it to its position `part_s` later. While a path jumps back to its beginning, the velocity
// is zero.
Motion motion_on(const MotionPath& path, const Pose& start, Vec3 center_m, double time_s, double part_s);

}  // namespace ringdown::scene
