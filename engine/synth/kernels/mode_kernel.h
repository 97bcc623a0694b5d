// The inner loop: sums damped sinusoids, with modes in SIMD lanes.
//
// Mode i sounds as Re(z_i p_i^n), n = 0, 1, ... frames. The state z is complex double and anchored: after a chunk it is
// multiplied once by p^frames, so neither frequency nor decay drifts. Inside the chunk n = kRun r + l, and the samples
// are products of z p^(kRun r), r = 0, 1, ..., and of p^l, l < kRun, from a table. Both are float, whose rounding
// leaves errors near 1e-7 of the mode's amplitude, at any pitch and decay.
//
// Modes come in groups of kModePadding. Only groups in a list are visited, and those that have died away leave it. One
// source, compiled for every instruction set that Highway knows and chosen when the program starts.
#pragma once

#include "engine/base/realtime.h"

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// Maximum number of frames per call.
inline constexpr std::size_t kChunkFrames = 128;

// Modes in a group. Arrays of modes are padded with silent ones (z = p = 0) to a multiple of this.
inline constexpr std::size_t kModePadding = 8;

// Number of frames computed from one anchor.
inline constexpr std::size_t kRun = 16;

// Gains by which modes are heard in one call: z sounds as z (gain + step j) in frame j of the call, complex, and
// frequencies may be Doppler-shifted. The states' own evolution is separate. Arrays have one number for each mode,
// 64-byte aligned.
struct Hearing {
  const float* gain_re = nullptr;  // null: 1
  const float* gain_im = nullptr;
  const float* step_re = nullptr;  // per frame; null: the gain is constant
  const float* step_im = nullptr;
  float offset = 0;  // frames from the moment of `gain` to the beginning of the call
  // Moments only: after `frames` the modes are moved on by p^(rate frames). In the middle of the call they are `bend`
  // frames ahead of a steady rate.
  double rate = 1;
  double bend = 0;
  const double* log_re = nullptr;  // log p; needed if the rate is not 1 or there is a bend
  const double* log_im = nullptr;
};

// Structure of arrays. Each array is 64-byte aligned and a multiple of kModePadding long.
struct ModeArrays {
  double* z_re = nullptr;
  double* z_im = nullptr;
  const double* pole_re = nullptr;  // p = exp((-d + i omega) / sample rate)
  const double* pole_im = nullptr;
  const double* advance_re = nullptr;  // p^frames of the call; null: computed from p
  const double* advance_im = nullptr;
  const float* stride_re = nullptr;  // p^kRun
  const float* stride_im = nullptr;
  const float* runs = nullptr;       // 2 kRun numbers for each mode; see run_of()
  const Hearing* hearing = nullptr;  // null: z sounds as it is
};

// Returns Re(p^l) for l < kRun, then -Im(p^l); s = log p. [any]
std::array<float, 2 * kRun> run_of(std::complex<double> s);

// The sounding groups. Group g holds modes g * kModePadding and the kModePadding - 1 after it.
struct ActiveGroups {
  std::uint32_t* list = nullptr;
  std::size_t count = 0;
};

// Limits of |z|^2.
struct EnergyLimits {
  double floor = 0;  // a group all of whose modes are below their share leaves the list, and its states become zero
  double max = 0;    // a larger energy, or NaN, means that something is wrong
};

// |z|^2 of a mode above which something is wrong: 240 dB over full scale. NaN counts as above.
inline constexpr double kAbsurdEnergy = 1e24;
inline constexpr EnergyLimits kKeepAllGroups{-1, kAbsurdEnergy};

// Adds the modes' sum to out[0, frames) and moves their states on by `frames` <= kChunkFrames. Returns false, without
// adding anything, if the energy of a new state exceeds `max` or is NaN. [audio]
bool render_modes(const ModeArrays& modes, ActiveGroups& active, const EnergyLimits& limits, double* out,
                  std::size_t frames) REALTIME;

// to = p^frames for the first `count` modes, a multiple of kModePadding. [audio]
void fill_advances(const ModeArrays& modes, std::size_t count, std::size_t frames, double* to_re,
                   double* to_im) REALTIME;

// z *= p^frames for the first `count` modes, a multiple of kModePadding: at most 2 log2(frames) products a mode,
// relative error about 1e-16 frames. [audio]
void skip_modes(const ModeArrays& modes, std::size_t count, std::uint64_t frames) REALTIME;

// Returns the instruction set in use: "AVX3", "AVX2", "NEON", ... [any]
const char* kernel_target();

}  // namespace ringdown::synth
