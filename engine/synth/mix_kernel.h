// What is done to samples rather than to modes. [audio]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

// left += left_gain * mono, right += right_gain * mono.
void add_to_stereo(const double* mono, double left_gain, double right_gain, double* left, double* right,
                   std::size_t frames) RINGDOWN_REALTIME;

// to = from; returns the largest |to|, without numbers that are none.
float write_samples(const double* from, float* to, std::size_t frames) RINGDOWN_REALTIME;

}  // namespace ringdown::synth
