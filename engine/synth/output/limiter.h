// Keeps a stereo mix below a ceiling: a look-ahead limiter, which turns down before a peak and not after it.
//
// Stages for each frame: the gain that it needs; the minimum of these gains over the frames to come, as far as the
// delay reaches; a return to 1 with a time constant of kRelease_s; and a mean over the delay, with triangular weights.
// A weighted mean of gains that are all small enough for a frame is small enough too: no sample passes the ceiling, not
// even by its last bit. Gains are whole multiples of 2^-40, so that their sums are exact: if nothing has passed the
// ceiling for a while, the gain is 1 and samples are unchanged.
//
// The ceiling applies to samples; the wave that a converter draws between them can rise above it, by some tenths of a
// dB.
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

class Limiter {
 public:
  static constexpr double kLookAhead_s = 0.002;  // also the delay
  static constexpr double kRelease_s = 0.1;

  // The ceiling in dB of full scale, -120 ... 120. [worker]
  Limiter(double sample_rate_hz, double ceiling_db);

  // Returns the delay from input to output, in frames. [any]
  [[nodiscard]] std::size_t delay_frames() const { return delay_; }

  // Returns the largest possible output sample. [any]
  [[nodiscard]] float ceiling() const { return ceiling_; }

  // Processes any number of frames in place. Both channels get one common gain. A null channel counts as silent; a
  // frame with a NaN or infinity comes out silent. Returns the largest |sample| written. [audio]
  float process(float* left, float* right, std::size_t frames) REALTIME;

 private:
  using Gain = std::uint64_t;
  static constexpr Gain kUnity = Gain{1} << 40;

  // The sum of the last `length` numbers, which are `value` at first.
  class Sum {
   public:
    Sum(std::size_t length, Gain value) : values_(length, value), sum_(length * value) {}
    Gain push(Gain value) REALTIME;

   private:
    std::vector<Gain> values_;
    std::size_t at_ = 0;
    Gain sum_;
  };

  // The minimum of the last `length` numbers; numbers before the first count as kUnity.
  class Least {
   public:
    explicit Least(std::size_t length) : entries_(length + 1), length_(length) {}
    Gain push(Gain value) REALTIME;

   private:
    struct Entry {
      Gain value;
      std::uint64_t frame;
    };
    std::vector<Entry> entries_;  // a ring; values ascend, each being the minimum from its frame on
    std::size_t length_, first_ = 0, count_ = 0;
    std::uint64_t frame_ = 0;
  };

  [[nodiscard]] double gain_for(float peak) REALTIME;

  const float ceiling_;
  const std::size_t first_box_, second_box_;  // lengths of the two successive means
  const std::size_t delay_;
  const double release_;  // share of the distance to 1 that is recovered per frame
  Least min_;
  Gain released_ = kUnity;
  Sum first_, second_;
  std::size_t unsettled_ = 0;                  // frames until the gain is 1 again without further peaks
  std::vector<float> late_left_, late_right_;  // rings
  std::size_t at_ = 0;
};

}  // namespace ringdown::synth
