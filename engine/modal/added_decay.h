// Finds how much faster modes decay under dampers.
//
// A contact that resists the surface's speed v with a force c v adds c |phi_m(p) . n|^2 / 2 to the decay rate of mode
// m: a mode with a node there rings on, one with its largest motion there dies first. Its coupling of modes to each
// other is left out, as in Zheng & James, ACM Trans. Graph. 30(4), 2011.
#pragma once

#include "engine/modal/damper.h"
#include "engine/modal/strike_map.h"

#include <vector>

namespace ringdown::modal {

// The decay rate [1/s] that all dampers together add to each mode of the bank as baked. With another density, divide it
// by the density's factor. [worker]
std::vector<double> added_decay(const StrikeMap& map, const Dampers& dampers);

}  // namespace ringdown::modal
