// Modes under forces that last: moved on sample by sample.
//
// Beside mode_kernel.h, which lets modes ring freely and looks at them once in a chunk, this is slow (some 12 ns for a
// mode and chunk instead of 2), so it runs for what is being touched and no longer.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/mode_kernel.h"

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

// A two-way contact's force at one place in one direction, constant over each step.
struct PortForce {
  const double *kick_re = nullptr,
               *kick_im = nullptr;  // what a force of 1 N adds to each mode in a step, 64-byte aligned
  const double* samples = nullptr;  // the force in each step [N]
};
inline constexpr std::size_t kMaxPortForces = 24;  // on one object

// As drive_modes(), but every frame is `substeps` steps, whose poles `modes` has, and `ports` push as well. `forces`
// act at the beginning of each frame, and `out` gets a sample for each frame. [audio]
double drive_touched(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                     std::span<const PortForce> ports, double* out, std::size_t frames,
                     std::size_t substeps) RINGDOWN_REALTIME;

// out[k][n] = sum over modes of weights[k] Re(z p^n) for n = 0 ... count - 1 <= kChunkFrames: how the surface moves at
// a few places when nothing pushes. The states stay as they are. [audio]
inline constexpr std::size_t kMaxPlaces = 24;
void free_motion(const ModeArrays& modes, std::size_t columns, std::span<const double* const> weights,
                 std::span<double* const> out, std::size_t count) RINGDOWN_REALTIME;

// to[i] -= force * taps[i] for each of `rows`, i < count. [audio]
struct TapRow {
  const double* taps = nullptr;
  double* to = nullptr;
  double force = 0;
};
void add_taps(std::span<const TapRow> rows, std::size_t count) RINGDOWN_REALTIME;

}  // namespace ringdown::synth
