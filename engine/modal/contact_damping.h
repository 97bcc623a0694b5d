// What touches an object and does not strike it damps it: a hand on a bell, a table under a bowl.
//
// A contact that resists the surface's speed with a force c v adds c |phi_m(p) . n|^2 / 2 to the decay rate of mode m:
// a mode with a node there rings on, one with its largest motion there dies first. What it couples between modes is
// left out, as in Zheng & James, ACM Trans. Graph. 30(4), 2011.
#pragma once

#include "engine/modal/strike_map.h"

#include <vector>

namespace ringdown::modal {

struct ContactDamping {
  Vec3 point_m;             // object frame; the nearest point of the surface is touched
  Vec3 direction;           // of the motion that is resisted, any length; 0 0 0: any motion
  double damping_ns_m = 0;  // force per speed; 0: nothing touches
  friend bool operator==(const ContactDamping&, const ContactDamping&) = default;
};

// What it adds to the decay rate [1/s] of each mode of the bank as baked; divided by the density's factor for another
// density. [worker]
std::vector<double> added_decay(const StrikeMap& map, const ContactDamping& contact);

}  // namespace ringdown::modal
