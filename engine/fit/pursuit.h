// Short modes of a dull sound, one after the other: of all damped sinusoids the one that explains most of what is left
// is taken out, and again, as long as one explains much more than noise could [matching pursuit: Mallat & Zhang, IEEE
// Trans. Signal Processing 41, 1993; with damped sinusoids: Goodwin & Vetterli, ibid. 47, 1999]. Where modes die within
// a few cycles, ESPRIT finds too few samples to tell them from noise (poles.h). [worker]
#pragma once

#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

struct PursuitOptions {
  double low_hz = 20, high_hz = 20000;
  std::size_t max_modes = 40;
  double noise = 0;  // mean square of the samples' noise
};

inline constexpr double kPursuit_s = 0.1;  // what is looked at after the beginning of the sound

// Modes of `left`, the first kPursuit_s of what longer modes leave of a sound, by the energy that each explained.
std::vector<Mode> pursue(std::span<const double> left, double sample_rate_hz, const PursuitOptions& options);

}  // namespace ringdown::fit
