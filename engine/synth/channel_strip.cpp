#include "engine/synth/channel_strip.h"

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {

void ChannelStrip::set_gain(double gain, Frame at, Frame length) RINGDOWN_REALTIME {
  set_gain_ = gain;
  if (!silent_) gain_.aim(gain, at, length);
}

void ChannelStrip::set_silent(bool silent, Frame at, Frame length) RINGDOWN_REALTIME {
  if (silent == silent_) return;
  silent_ = silent;
  gain_.aim(silent ? 0 : set_gain_, at, length);
}

void ChannelStrip::set_pan(double pan, Frame at, Frame length) RINGDOWN_REALTIME {
  const double angle = 0.25 * std::numbers::pi * (1 + pan);
  left_.aim(std::cos(angle), at, length);
  right_.aim(std::sin(angle), at, length);
}

void ChannelStrip::rescale(Frame now, double ratio) {
  for (Ramp* ramp : {&gain_, &left_, &right_}) {
    ramp->begin = rescaled(ramp->begin, now, ratio);
    ramp->end = rescaled(ramp->end, now, ratio);
  }
}

double ChannelStrip::max_gain() const RINGDOWN_REALTIME { return std::max(std::abs(gain_.from), std::abs(gain_.to)); }

bool ChannelStrip::heard(ChannelSet wanted) const RINGDOWN_REALTIME {
  return (wanted & (only(kLeft) | only(kRight) | (bus_ == kNoBus ? 0 : only(bus_)))) != 0;
}

ChannelStrip::Shares ChannelStrip::shares() const RINGDOWN_REALTIME {
  return {gain_.to * left_.to, gain_.to * right_.to, bus_ == kNoBus ? 0.0 : gain_.to};
}

void ChannelStrip::add_samples(const double* mono, std::size_t begin, std::size_t end, const Chunk& chunk,
                               ChannelSums& sums) const RINGDOWN_REALTIME {
  const Frame first = chunk.begin + static_cast<Frame>(begin);
  const Ramp unity{1, 1};
  const auto add_to = [&](std::size_t channel, const Ramp& share) RINGDOWN_REALTIME {
    if (!contains(chunk.wanted, channel)) return;
    double* const out = sums.samples(channel);
    if (gain_.still_at(first) && share.still_at(first)) {
      return add_scaled(mono + begin, gain_.to * share.to, out + begin, end - begin);
    }
    for (std::size_t n = begin; n < end; ++n) {
      const Frame frame = chunk.begin + static_cast<Frame>(n);
      out[n] += gain_.at(frame) * share.at(frame) * mono[n];
    }
  };
  add_to(kLeft, left_);
  add_to(kRight, right_);
  if (bus_ != kNoBus) add_to(bus_, unity);
}

std::span<const MomentTarget> ChannelStrip::moment_targets(
    ChannelSet wanted, ChannelSums& sums, std::array<MomentTarget, kOutputs>& targets) const RINGDOWN_REALTIME {
  std::size_t count = 0;
  const auto aim = [&](std::size_t channel, double gain) RINGDOWN_REALTIME {
    if (contains(wanted, channel)) targets[count++] = {sums.moments(channel), static_cast<float>(gain)};
  };
  aim(kLeft, gain_.to * left_.to);
  aim(kRight, gain_.to * right_.to);
  if (bus_ != kNoBus) aim(bus_, gain_.to);
  return {targets.data(), count};
}

}  // namespace ringdown::synth
