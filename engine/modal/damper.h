// Something that lies on an object and resists its motion: a hand on a bell, a table under a bowl.
#pragma once

#include "engine/base/vec3.h"

#include <cstdint>
#include <map>

namespace ringdown::modal {

struct Damper {
  Vec3 point_m;             // object frame; it acts at the nearest point of the surface
  Vec3 direction;           // of the motion that it resists, any length; 0 0 0: any motion
  double damping_ns_m = 0;  // force per speed; 0: no damper
  friend bool operator==(const Damper&, const Damper&) = default;
};

// Dampers of an object; those from kFirstSceneDamper on are an embedded scene's.
inline constexpr std::uint32_t kMaxDampers = 16, kFirstSceneDamper = 8;

// All dampers of an object, by their numbers, which are below kMaxDampers.
using Dampers = std::map<std::uint32_t, Damper>;

}  // namespace ringdown::modal
