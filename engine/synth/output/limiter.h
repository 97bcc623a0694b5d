// Keeps a stereo mix below a ceiling: a limiter that looks ahead, so that it turns down before a peak comes and not
// after.
//
// For each frame: the gain that it needs; the least of these over the frames to come, as far as the delay reaches;
// from there back to 1 with a time constant of kRelease_s; then a mean over the delay, weighted like a triangle. A
// weighted mean of numbers that are all small enough for a frame is small enough for it: no sample passes the ceiling,
// by no unit in its last place. Gains are whole numbers of 2^-40, so that sums of them are exact: when nothing has
// passed the ceiling for a while, the gain is 1 and samples come out as they went in.
//
// The ceiling is for samples; the wave that a converter draws between them can rise above it, by some tenths of a dB.
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

  // Frames by which what comes out is later than what goes in. [any]
  [[nodiscard]] std::size_t delay_frames() const { return delay_; }

  // The largest sample that can come out. [any]
  [[nodiscard]] float ceiling() const { return ceiling_; }

  // In place; any number of frames. Both channels get the same gain. A channel that is null is taken as silent; a frame
  // with a number that is not one comes out silent. Returns the largest |sample| that it wrote. [audio]
  float process(float* left, float* right, std::size_t frames) RINGDOWN_REALTIME;

 private:
  using Gain = std::uint64_t;
  static constexpr Gain kUnity = Gain{1} << 40;

  // The sum of the last `length` numbers; at first they are all `value`.
  class Sum {
   public:
    Sum(std::size_t length, Gain value) : values_(length, value), sum_(length * value) {}
    Gain push(Gain value) RINGDOWN_REALTIME;

   private:
    std::vector<Gain> values_;
    std::size_t at_ = 0;
    Gain sum_;
  };

  // The least of the last `length` numbers; those before the first count as kUnity.
  class Least {
   public:
    explicit Least(std::size_t length) : entries_(length + 1), length_(length) {}
    Gain push(Gain value) RINGDOWN_REALTIME;

   private:
    struct Entry {
      Gain value;
      std::uint64_t frame;
    };
    std::vector<Entry> entries_;  // a ring: values ascend, each the least from its frame on
    std::size_t length_, first_ = 0, count_ = 0;
    std::uint64_t frame_ = 0;
  };

  [[nodiscard]] double gain_for(float peak) RINGDOWN_REALTIME;

  const float ceiling_;
  const std::size_t first_box_, second_box_;  // lengths of two means, one after the other
  const std::size_t delay_;
  const double release_;  // share of the way back that is gone in a frame
  Least least_;
  Gain released_ = kUnity;
  Sum first_, second_;
  std::size_t unsettled_ = 0;                  // frames after which the gain is 1 if nothing more happens
  std::vector<float> late_left_, late_right_;  // rings
  std::size_t at_ = 0;
};

}  // namespace ringdown::synth
