// What touches an object and does not strike it damps it: a hand on a bell, a table under a bowl.
#pragma once

#include "engine/base/vec3.h"

#include <cstdint>
#include <map>

namespace ringdown::modal {

struct ContactDamping {
  Vec3 point_m;             // object frame; the nearest point of the surface is touched
  Vec3 direction;           // of the motion that is resisted, any length; 0 0 0: any motion
  double damping_ns_m = 0;  // force per speed; 0: nothing touches
  friend bool operator==(const ContactDamping&, const ContactDamping&) = default;
};

// Touches of an object; those from kFirstSceneTouch on are an embedded scene's.
inline constexpr std::uint32_t kMaxTouches = 16, kFirstSceneTouch = 8;

// All that touches an object, each by its number, below kMaxTouches.
using Touches = std::map<std::uint32_t, ContactDamping>;

}  // namespace ringdown::modal
