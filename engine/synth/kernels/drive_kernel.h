// Modes under lasting forces, computed sample by sample.
//
// This is slow (some 12 ns for a mode and chunk instead of the 2 ns of mode_kernel.h, which lets modes ring freely and
// visits them once in a chunk), so it runs only for objects while they are touched.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/mode_kernel.h"

#include <cstddef>
#include <span>

namespace ringdown::synth {

// A force at one place of an object.
struct Force {
  const double* amplitudes = nullptr;  // each mode's amplitude per unit impulse (ModeTable::strike), 64-byte aligned
  const double* samples = nullptr;     // impulse in each frame
};
inline constexpr std::size_t kMaxForces = 4;  // forces on one object at a time

// Adds to out[0, frames) the sum of the first `columns` modes, a multiple of kModePadding, and moves their states on by
// `frames` <= kChunkFrames. An impulse in frame n sounds from frame n + 1 on. Returns the sum of |z|^2 of the final
// states. [audio]
double drive_modes(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces, double* out,
                   std::size_t frames) REALTIME;

// A two-way contact's force at one place in one direction, constant over each step. A force of 1 N changes a mode's
// state by its weight at the place times its response, which is the same for all places. Arrays are 64-byte aligned.
struct PortForce {
  const double* weight = nullptr;   // displacement of the place per Re z [m]
  const double* samples = nullptr;  // force in each step [N]
};
inline constexpr std::size_t kMaxPortForces = 24;  // ports on one object
struct PortForces {
  const double *response_re = nullptr, *response_im = nullptr;
  std::span<const PortForce> ports;
};

// Like drive_modes(), but every frame is `substeps` steps, for which `modes` has the poles, and `ports` push as well.
// `forces` act at the beginning of each frame, and `out` gets a sample for each frame. Without `out`, which must also
// be without `forces`, only the states are moved on, at half the cost. [audio]
double drive_touched(const ModeArrays& modes, std::size_t columns, std::span<const Force> forces,
                     const PortForces& ports, double* out, std::size_t frames, std::size_t substeps) REALTIME;

// out[k][n] = sum over modes of weights[k] Re(z p^n) for n = 0 ... count - 1 <= kChunkFrames: the free motion of the
// surface at a few places. Does not change the states. [audio]
inline constexpr std::size_t kMaxPlaces = 25;
void free_motion(const ModeArrays& modes, std::size_t columns, std::span<const double* const> weights,
                 std::span<double* const> out, std::size_t count) REALTIME;

// to[i] -= force * taps[i] for each of `rows`, i < count, and for up to kModePadding - 1 numbers after them. [audio]
struct TapRow {  // without initial values, because arrays of rows are filled as far as they are used
  const double* taps;
  double* to;
  double force;
};
void add_taps(std::span<const TapRow> rows, std::size_t count) REALTIME;

// out[n] += sum over m < n of force[m] answer[n - 1 - m] for n < count, a multiple of kAnswerPadding: the samples of a
// force, from those of a force of 1 N in one step. `answer` has kAnswerPadding zeros before its first number. [audio]
inline constexpr std::size_t kAnswerPadding = 16;
void add_answer(const double* force, const double* answer, double* out, std::size_t count) REALTIME;

}  // namespace ringdown::synth
