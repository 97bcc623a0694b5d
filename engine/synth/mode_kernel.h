// The inner loop: sums damped sinusoids, modes in SIMD lanes.
//
// Mode i sounds as Re(z_i p_i^n), n = 0, 1, ... frames. The state z is complex double and anchored: after a chunk it is
// multiplied once by p^frames, so neither frequency nor decay drifts. Inside the chunk the samples follow the two-pole
// recurrence y[n] = 2 Re(p) y[n-1] - |p|^2 y[n-2], started afresh from z, also in double: its error stays below 1e-12
// of the mode's amplitude from 20 Hz to Nyquist at every sample rate.
//
// One source, compiled for every instruction set that Highway knows and chosen when the program starts.
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

// Frames that one call may render.
inline constexpr std::size_t kChunkFrames = 64;

// Arrays of modes are padded with silent ones (z = p = 0) to a multiple of this.
inline constexpr std::size_t kModePadding = 8;

// Structure of arrays; each holds `count` numbers, 64-byte aligned, `count` a multiple of kModePadding.
struct ModeArrays {
  double* z_re = nullptr;
  double* z_im = nullptr;
  const double* pole_re = nullptr;  // p = exp((-d + i omega) / sample rate)
  const double* pole_im = nullptr;
  const double* chunk_pole_re = nullptr;  // p^kChunkFrames
  const double* chunk_pole_im = nullptr;
  std::size_t count = 0;
};

// Adds the modes' sum to out[0, frames) and moves their states on by `frames` <= kChunkFrames. Returns the sum of
// |z|^2 over the states it left behind. A sum, because it stays not finite when any state is not; the largest would
// not: a vector maximum forgets a NaN that meets a number. [audio]
double render_modes(const ModeArrays& modes, double* out, std::size_t frames) RINGDOWN_REALTIME;

// The instruction set in use: "AVX3", "AVX2", "NEON", ... [any]
const char* kernel_target();

}  // namespace ringdown::synth
