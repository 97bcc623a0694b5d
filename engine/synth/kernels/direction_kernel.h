// Finds the gains of all modes of a bank in one direction. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/modal/air_absorption.h"
#include "engine/modal/direction_map.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// Computes the gains of the modes of `map`, by ascending frequency, in the direction for which `harmonics` were
// computed (modal::real_harmonics, to at least map.degree()). `re` and `im` have room for kGroup times map.groups()
// numbers.
void look_up(const modal::DirectionMap& map, const float* harmonics, float* re, float* im) REALTIME;

// out[c] = exp(-alpha(f_c) distance): the share of each mode that is left after its path through the air. `count` is a
// multiple of 8, `frequency_hz` and `out` 64-byte aligned.
void find_absorption(const modal::AirAbsorption& air, double distance_m, const float* frequency_hz, std::size_t count,
                     float* out) REALTIME;

}  // namespace ringdown::synth
