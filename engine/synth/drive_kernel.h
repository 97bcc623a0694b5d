// Modes under forces that last: moved on sample by sample.
//
// Beside mode_kernel.h, which lets modes ring freely and looks at them once in a chunk, this is slow (some 12 ns for a
// mode and chunk instead of 2), so it runs for what is being touched and no longer.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/mode_kernel.h"

#include <cstddef>
#include <span>

namespace ringdown::synth {

// A force at one place of an object.
struct Force {
  const double* amplitudes = nullptr;  // what an impulse of 1 gives each mode (ModeTable::strike), 64-byte aligned
  const double* samples = nullptr;     // the impulse in each frame
};
inline constexpr std::size_t kMaxForces = 4;  // on one object at a time

// Adds to out[0, frames) the sum of the first `columns` modes, a multiple of kModePadding, and moves them on by
// `frames` <= kChunkFrames: an impulse in frame n sounds from frame n + 1 on. Returns the sum of |z|^2 of the states it
// leaves. [audio]
double drive_modes(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                   std::size_t frames) RINGDOWN_REALTIME;

}  // namespace ringdown::synth
