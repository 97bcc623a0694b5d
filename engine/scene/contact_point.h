// Plain data that the simulation of bodies returns: where bodies are, and where they touch. SI units, world axes. [any
// thread]
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/description.h"

#include <cstdint>

namespace ringdown::scene {

// A body's number, never reused in one scene. Statics are numbered from kFirstStatic.
using BodyId = std::uint32_t;
inline constexpr BodyId kFirstStatic = 1u << 31;

// A body's position and velocity, both of its centre of mass, and its rotation and spin.
struct Motion {
  Vec3 position_m;
  Rotation rotation;  // object frame -> world
  Vec3 velocity_m_s;
  Vec3 spin_rad_s;

  [[nodiscard]] Vec3 velocity_at(Vec3 world_m) const { return velocity_m_s + cross(spin_rad_s, world_m - position_m); }
};

// The motions of two bodies when they touch. A static has the motion of a body at rest at the origin.
struct MotionPair {
  Motion of_body, of_other;
};

// One point at which two bodies touched in one step.
struct ContactPoint {
  BodyId body = 0, other = 0;  // `body` can move; `other` may be a static
  Vec3 point_m;
  Vec3 normal;                          // unit, into `body`
  double depth_m = 0;                   // how far the two overlapped when the contact was found
  Vec3 impulse_ns;                      // received by `body` in this step; `other` received the opposite
  double approach_m_s = 0;              // closing speed along the normal just before the contact
  double found_s = 0;                   // when the contact was found, from the beginning of the step
  const MotionPair* motions = nullptr;  // the bodies' motions at found_s; shared by all points of a pair, valid as long
                                        // as the point
};

// A body that moved in a step, and its motion at the end of the step.
struct MovedBody {
  BodyId id = 0;
  Motion motion;
};

}  // namespace ringdown::scene
