// Which samples cannot be sound. Kernels look at the energy of the states that they leave behind (kAbsurdEnergy), but a
// state can die within a chunk, and forces add to samples, too: so whoever adds samples up looks at these. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/mix_kernel.h"

#include <span>

namespace ringdown::synth {

// All the modes that a bank may have, each of an energy that is not absurd, add up to no larger sample.
inline constexpr double kAbsurdSample = 1e18;

// False when a sample is larger, or is not a number.
[[nodiscard]] inline bool are_sane(std::span<const double> samples) REALTIME {
  return all_within(samples.data(), kAbsurdSample, samples.size());
}

}  // namespace ringdown::synth
