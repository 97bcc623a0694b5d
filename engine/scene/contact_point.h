// The plain data that the simulation of bodies hands to everybody else: where bodies are, and where they touch. SI
// units, world axes. [any thread]
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/description.h"

#include <cstdint>

namespace ringdown::scene {

// A body's number, never used twice in one scene. Statics are numbered from kFirstStatic.
using BodyId = std::uint32_t;
inline constexpr BodyId kFirstStatic = 1u << 31;

// Where a body is and how it moves. The position and the velocity are those of the centre of mass.
struct Motion {
  Vec3 position_m;
  Rotation rotation;  // object frame -> world
  Vec3 velocity_m_s;
  Vec3 spin_rad_s;

  [[nodiscard]] Vec3 velocity_at(Vec3 world_m) const { return velocity_m_s + cross(spin_rad_s, world_m - position_m); }
};

// How two bodies move when they touch; a static's motion is that of the origin at rest.
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
  double approach_m_s = 0;              // speed along the normal at which the two came together just before
  double found_s = 0;                   // when the contact was found, from the beginning of the step
  const MotionPair* motions = nullptr;  // at that time; shared by the points of a pair, valid as long as the point
};

// A body that moved in a step, and its motion at the end of the step.
struct MovedBody {
  BodyId id = 0;
  Motion motion;
};

}  // namespace ringdown::scene
