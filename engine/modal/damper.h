// A damper lies on an object and resists its motion: a hand on a bell, a table under a bowl.
#pragma once

#include "engine/base/vec3.h"

#include <cstdint>
#include <map>

namespace ringdown::modal {

struct Damper {
  Vec3 point_m;             // object frame; the damper acts at the nearest point of the surface
  Vec3 direction;           // direction of the resisted motion, any length; 0 0 0: all directions
  double damping_ns_m = 0;  // force per speed; 0: no damper
  friend bool operator==(const Damper&, const Damper&) = default;
};

// Limits of damper numbers. Dampers from kFirstSceneDamper on belong to an embedded scene.
inline constexpr std::uint32_t kMaxDampers = 16, kFirstSceneDamper = 8;

// All dampers of an object by number, from 0 to kMaxDampers - 1.
using Dampers = std::map<std::uint32_t, Damper>;

}  // namespace ringdown::modal
