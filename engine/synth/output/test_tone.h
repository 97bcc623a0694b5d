// A sine on both sides of the mix, to check connections and levels. It starts, changes and stops without a click: its
// amplitude moves by full scale in kRamp_s, and its phase is continuous when the frequency changes.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <cstddef>
#include <optional>

namespace ringdown::synth {

class TestTone {
 public:
  static constexpr double kRamp_s = 0.01;

  // Sets the peak amplitude (1 is full scale; 0, the default, ends the tone) and the frequency. Frequencies from half
  // the sample rate up are silent. [any]
  void set(double amplitude, double frequency_hz) {
    frequency_hz_.store(frequency_hz, std::memory_order_relaxed);
    amplitude_.store(amplitude, std::memory_order_relaxed);
  }

  // Returns true if there is no tone. [audio]
  [[nodiscard]] bool off() const REALTIME { return level_ == 0 && amplitude_.load(std::memory_order_relaxed) == 0; }
  // Adds the tone's next frames to the sides that are not null. Returns the largest |sample| of these sides afterwards,
  // or nothing if there is no tone. [audio]
  std::optional<float> add(float* left, float* right, std::size_t frames, double sample_rate_hz) REALTIME;

 private:
  std::atomic<double> amplitude_{0}, frequency_hz_{440};
  double level_ = 0, phase_ = 0;  // used by the audio thread only
};

}  // namespace ringdown::synth
