// A sine on both sides of the mix, to check connections and levels by. It comes, changes and goes without a click: its
// amplitude moves by full scale in kRamp_s, and its phase goes on when the frequency changes.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <cstddef>
#include <optional>

namespace ringdown::synth {

class TestTone {
 public:
  static constexpr double kRamp_s = 0.01;

  // Its peak, 1 being full scale; 0, the default, ends it. Nothing sounds from half the sample rate up. [any]
  void set(double amplitude, double frequency_hz) {
    frequency_hz_.store(frequency_hz, std::memory_order_relaxed);
    amplitude_.store(amplitude, std::memory_order_relaxed);
  }

  // Adds its next frames to the sides that are not null. Returns the largest |sample| of these afterwards; nothing
  // where there is no tone. [audio]
  std::optional<float> add(float* left, float* right, std::size_t frames, double sample_rate_hz) RINGDOWN_REALTIME;

 private:
  std::atomic<double> amplitude_{0}, frequency_hz_{440};
  double level_ = 0, phase_ = 0;  // the audio thread's own
};

}  // namespace ringdown::synth
