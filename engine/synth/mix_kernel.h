// Kernels that work on samples rather than on modes. [audio]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

// out += gain * from.
void add_scaled(const double* from, double gain, double* out, std::size_t frames) RINGDOWN_REALTIME;

// to = from; returns the largest |to|, without numbers that are none.
float write_samples(const double* from, float* to, std::size_t frames) RINGDOWN_REALTIME;

}  // namespace ringdown::synth
