// Finds how much faster modes decay under dampers.
//
// A contact that resists the surface's speed v with a force c v adds c |phi_m(p) . n|^2 / 2 to the decay rate of mode
// m: a mode with a node at the contact rings on, a mode with its largest motion there dies first. The coupling between
// modes that the contact causes is left out, as in Zheng & James, ACM Trans. Graph. 30(4), 2011.
#pragma once

#include "engine/modal/damper.h"
#include "engine/modal/strike_map.h"

#include <vector>

namespace ringdown::modal {

// Returns the decay rate [1/s] that all dampers together add to each mode of the bank as baked. With another density,
// divide the rates by the density's factor. [worker]
std::vector<double> added_decay(const StrikeMap& map, const Dampers& dampers);

}  // namespace ringdown::modal
