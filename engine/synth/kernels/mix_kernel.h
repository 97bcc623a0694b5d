// Kernels that work on samples rather than on modes. [audio]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

// out += gain * from.
void add_scaled(const double* from, double gain, double* out, std::size_t frames) REALTIME;
// out = gain * from.
void write_scaled(const double* from, double gain, double* out, std::size_t frames) REALTIME;

// Applies two filters to the samples, from the last tap on, each with its own result: out[n] += sum over j < taps of
// reversed[j] * samples[n + j]. Reads and writes up to kFilterOverrun frames beyond `frames`.
inline constexpr std::size_t kFilterOverrun = 64;
struct FilterOutput {
  const float* reversed;
  float* out;
};
void add_filtered(const float* samples, std::size_t taps, const FilterOutput& first, const FilterOutput& second,
                  std::size_t frames) REALTIME;

// Returns true if no |sample| is above `max`, and none is not-a-number.
[[nodiscard]] bool all_within(const double* samples, double max, std::size_t count) REALTIME;

// to = from; returns the largest |to|. If a sample would not be finite, sets to = 0 throughout and returns infinity.
float write_samples(const double* from, float* to, std::size_t frames) REALTIME;

}  // namespace ringdown::synth
