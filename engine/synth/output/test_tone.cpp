#include "engine/synth/output/test_tone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {

std::optional<float> TestTone::add(float* left, float* right, std::size_t frames, double sample_rate_hz) REALTIME {
  const double frequency_hz = frequency_hz_.load(std::memory_order_relaxed);
  const bool playable = frequency_hz < 0.5 * sample_rate_hz;
  const double target = playable ? amplitude_.load(std::memory_order_relaxed) : 0;
  if (level_ == 0) phase_ = 0;
  if (level_ == 0 && target == 0) return std::nullopt;
  const double step = 1 / (kRamp_s * sample_rate_hz), turn = 2 * std::numbers::pi * frequency_hz / sample_rate_hz;
  float highest = 0;
  for (std::size_t n = 0; n < frames; ++n) {
    level_ += std::clamp(target - level_, -step, step);
    const auto sample = static_cast<float>(level_ * std::sin(phase_));
    phase_ += turn;
    for (float* const side : {left, right}) {
      if (side) highest = std::max(highest, std::abs(side[n] += sample));
    }
  }
  phase_ = std::remainder(phase_, 2 * std::numbers::pi);
  return highest;
}

}  // namespace ringdown::synth
