// Finds short modes of a dull sound, one after the other. Of all damped sinusoids, the one that explains most of the
// remaining sound is subtracted, and this is repeated as long as a sinusoid explains much more than noise could
// [matching pursuit: Mallat & Zhang, IEEE Trans. Signal Processing 41, 1993; with damped sinusoids: Goodwin & Vetterli,
// ibid. 47, 1999]. Modes that die within a few cycles have too few samples for ESPRIT to tell them from noise
// (poles.h). [worker]
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

inline constexpr double kPursuit_s = 0.1;  // time after the beginning of the sound that is analysed

// The modes of `left`, the first kPursuit_s of a sound without its longer modes, sorted by the energy that each
// explains.
std::vector<Mode> pursue(std::span<const double> left, double sample_rate_hz, const PursuitOptions& options);

}  // namespace ringdown::fit
