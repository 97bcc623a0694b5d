#include "engine/synth/output/limiter.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ringdown::synth {
namespace {

std::size_t half_of_look_ahead(double sample_rate_hz) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(0.5 * Limiter::kLookAhead_s * sample_rate_hz));
}

float not_above(double value) {
  const auto rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? std::nextafter(rounded, 0.0f) : rounded;
}

}  // namespace

Limiter::Limiter(double sample_rate_hz, double ceiling_db)
    : ceiling_(not_above(std::pow(10.0, ceiling_db / 20))),
      first_box_(half_of_look_ahead(sample_rate_hz)),
      second_box_(first_box_ + 1),
      delay_(first_box_ + second_box_ - 2),
      release_(-std::expm1(-1 / (kRelease_s * sample_rate_hz))),
      min_(delay_ + 1),
      first_(first_box_, kUnity),
      second_(second_box_, kUnity * first_box_),
      late_left_(delay_ + 1, 0.0f),
      late_right_(delay_ + 1, 0.0f) {}

Limiter::Gain Limiter::Sum::push(Gain value) REALTIME {
  Gain& oldest = values_[at_];
  sum_ += value - oldest;
  oldest = value;
  at_ = at_ + 1 == values_.size() ? 0 : at_ + 1;
  return sum_;
}

// The minimum of a sliding window by a monotonic queue. An entry followed by a smaller or equal value can never be the
// minimum again, so it is dropped. Values in the queue ascend, and the first one is the minimum of the window; it is
// removed when the window has moved past its frame. Each value enters and leaves once, so the mean cost is constant.
Limiter::Gain Limiter::Least::push(Gain value) REALTIME {
  Entry* const ring = entries_.data();
  const std::size_t size = entries_.size();
  const auto place = [&](std::size_t i) REALTIME { return first_ + i < size ? first_ + i : first_ + i - size; };
  ++frame_;
  if (count_ > 0 && ring[first_].frame + length_ <= frame_) {
    first_ = place(1);
    --count_;
  }
  while (count_ > 0 && ring[place(count_ - 1)].value >= value) --count_;
  ring[place(count_++)] = {value, frame_};
  return ring[first_].value;
}

// Returns the gain of the frame that now leaves the delay, given the peak of the one that enters. It has four stages:
// the gain that the entering peak needs; the minimum of these gains over the delay; the release, an exponential return
// to 1 that the minimum interrupts; and two successive means of about half the delay each, which together weight the
// delay like a triangle and turn steps into smooth curves. While nothing is loud and all stages have settled at 1,
// there is nothing to do.
double Limiter::gain_for(float peak) REALTIME {
  const bool loud = peak > ceiling_;
  if (!loud && unsettled_ == 0) return 1;
  const double needed = static_cast<double>(ceiling_) / static_cast<double>(peak);
  const Gain min = min_.push(loud ? static_cast<Gain>(needed * static_cast<double>(kUnity)) : kUnity);
  constexpr Gain kNearUnity = kUnity >> 20;
  const Gain missing = kUnity - released_;
  const Gain back = static_cast<Gain>(release_ * static_cast<double>(missing)) + 1;
  released_ = std::min(min, missing < kNearUnity ? kUnity : released_ + back);
  const std::size_t to_settle = delay_ + 1 + first_box_ + second_box_;
  unsettled_ = loud || released_ < kUnity ? to_settle : unsettled_ - 1;
  const Gain sum = second_.push(first_.push(released_));
  return static_cast<double>(sum) / static_cast<double>(kUnity * first_box_ * second_box_);
}

float Limiter::process(float* left, float* right, std::size_t frames) REALTIME {
  float highest = 0;
  for (std::size_t n = 0; n < frames; ++n) {
    float& late_left = late_left_[at_];
    float& late_right = late_right_[at_];
    late_left = left ? left[n] : 0.0f;
    late_right = right ? right[n] : 0.0f;
    const float peak = std::max(std::abs(late_left), std::abs(late_right));
    if (!(std::abs(late_left) + std::abs(late_right) <= std::numeric_limits<float>::max())) {
      late_left = late_right = 0;
    }
    const double gain = gain_for(late_left == 0 && late_right == 0 ? 0.0f : peak);
    at_ = at_ == delay_ ? 0 : at_ + 1;
    const auto limited_left = static_cast<float>(gain * static_cast<double>(late_left_[at_]));
    const auto limited_right = static_cast<float>(gain * static_cast<double>(late_right_[at_]));
    if (left) left[n] = limited_left;
    if (right) right[n] = limited_right;
    highest = std::max({highest, std::abs(limited_left), std::abs(limited_right)});
  }
  return highest;
}

}  // namespace ringdown::synth
