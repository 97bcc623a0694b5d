// Finds how loud all modes of a bank are heard in one direction. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"
#include "engine/modal/air_absorption.h"
#include "engine/modal/direction_map.h"

#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// The gains of the modes of `map`, by ascending frequency, in the direction that `harmonics` were found for
// (modal::real_harmonics, to at least map.degree()). `re` and `im` have room for kGroup times map.groups() numbers.
void look_up(const modal::DirectionMap& map, const float* harmonics, float* re, float* im) RINGDOWN_REALTIME;

// out[c] = exp(-alpha(f_c) distance): what is left of each mode after its way through the air. `count` is a multiple of
// 8, `frequency_hz` and `out` 64-byte aligned.
void find_absorption(const modal::AirAbsorption& air, double distance_m, const float* frequency_hz, std::size_t count,
                     float* out) RINGDOWN_REALTIME;

}  // namespace ringdown::synth
