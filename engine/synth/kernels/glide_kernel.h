// These functions give eight modes at once the constants of a new pitch (modes/glide.h). [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/moments.h"

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace ringdown::synth {

inline constexpr double kPerBand = std::numbers::pi / static_cast<double>(kChunkFrames);  // [radians per frame]

// exp(i angle n) of kModePadding modes, for n = 1, kRun and kChunkFrames.
struct Turns {
  struct alignas(64) Row {
    double re[kModePadding], im[kModePadding];
  };
  Row frame, run, chunk;
};

// `angles` are in radians per frame, 64-byte aligned.
void find_turns(const double* angles, Turns& turns) REALTIME;

// The weights of moments.h for kModePadding modes, each seen from the centre of a band that may be its neighbour's.
struct MovedWeights {
  alignas(64) double decay[kModePadding], omega[kModePadding];  // log p = decay + i omega
  alignas(64) double band[kModePadding];
  alignas(64) float of[2 * kMoments][kModePadding];  // the result
};
void find_weights(MovedWeights& weights) REALTIME;

// The detuning of kModePadding modes by `count` others: out[i] = the sum of shares[l kModePadding + i] amounts[l].
void add_shares(const std::int8_t* shares, const float* amounts, std::size_t count, float* out) REALTIME;

}  // namespace ringdown::synth
