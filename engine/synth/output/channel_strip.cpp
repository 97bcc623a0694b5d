#include "engine/synth/output/channel_strip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ringdown::synth {
namespace {

constexpr double kLoudspeaker_rad = std::numbers::pi / 6;

}  // namespace

void ChannelStrip::set_gain(double gain, Frame at, Frame length) REALTIME {
  set_gain_ = gain;
  if (!silent_) gain_.aim(gain, at, length);
}

void ChannelStrip::set_silent(bool silent, Frame at, Frame length) REALTIME {
  if (silent == silent_) return;
  silent_ = silent;
  gain_.aim(silent ? 0 : set_gain_, at, length);
}

void ChannelStrip::set_pan(double pan, Frame at, Frame length) REALTIME {
  const double angle = 0.25 * std::numbers::pi * (1 + pan);
  left_.aim(std::cos(angle), at, length);
  right_.aim(std::sin(angle), at, length);
  const double azimuth = -kLoudspeaker_rad * pan;
  set_direction({std::cos(azimuth), std::sin(azimuth), 0}, at, length);
}

void ChannelStrip::set_direction(Vec3 towards, Frame at, Frame length) REALTIME {
  const AmbisonicGains gains = encode(towards);
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
    encoded_[c].aim(gains[c], at, length);
    encoded_to_[c] = static_cast<float>(gains[c]);
  }
}

ChannelStrip::ChannelStrip() REALTIME {
  const AmbisonicGains gains = encode({1, 0, 0});
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
    encoded_[c] = {gains[c], gains[c]};
    encoded_to_[c] = static_cast<float>(gains[c]);
  }
}

// Stereo hears left and right only: what is in front and what is behind sound alike.
ChannelStrip::Shares ChannelStrip::shares_at(const Place& place, Frame frame) const REALTIME {
  const double level = gain_.at(frame) * place.level;
  const double angle = 0.25 * std::numbers::pi * (1 - std::clamp(place.toward.y, -1.0, 1.0));
  Shares shares{level * std::cos(angle), level * std::sin(angle), level};
  const AmbisonicGains field = encode(place.toward);
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) shares[kFirstField + c] = level * field[c];
  return shares;
}

ChannelStrip::Shares ChannelStrip::shares_at(Frame frame) const REALTIME {
  const double gain = gain_.at(frame);
  Shares shares{gain * left_.at(frame), gain * right_.at(frame), gain};
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) shares[kFirstField + c] = gain * encoded_[c].at(frame);
  return shares;
}

// Returns the gains on the straight line from one place to another; after its end, those of the end.
ChannelStrip::Shares ChannelStrip::line_at(Frame frame) const REALTIME {
  if (frame >= line_.end) return to_;
  const double share = static_cast<double>(frame - line_.begin) / static_cast<double>(line_.end - line_.begin);
  Shares shares;
  for (std::size_t i = 0; i < kOutputs; ++i) shares[i] = from_[i] + share * (to_[i] - from_[i]);
  return shares;
}

void ChannelStrip::place(const Place& from, const Place& to, Span span, double share) REALTIME {
  const double gain = gain_.at(span.end);
  const bool stays = placed_ && share == 1 && to == place_ && gain == place_gain_;
  const Shares then = stays ? to_ : shares_at(to, span.end);
  go(share > 1 ? shares_at(from, span.begin)
     : placed_ ? line_at(span.begin)
               : shares_at(span.begin),
     then, span, std::min(share, 1.0));
  place_ = to;
  place_gain_ = share < 1 ? std::numeric_limits<double>::quiet_NaN() : gain;
}

bool ChannelStrip::placed_until(Frame end) const REALTIME {
  return placed_ && line_.end == end && (std::isnan(place_gain_) || gain_.at(end) == place_gain_);
}

void ChannelStrip::place_nowhere(Span span, double share) REALTIME {
  go(line_at(span.begin), shares_at(span.end), span, share);
  place_gain_ = std::numeric_limits<double>::quiet_NaN();
}

void ChannelStrip::stand(Frame now) REALTIME {
  if (now < line_.end) place_gain_ = std::numeric_limits<double>::quiet_NaN();
  from_ = to_ = line_at(now);
}

void ChannelStrip::go(const Shares& from, const Shares& to, Span span, double share) REALTIME {
  from_ = from;
  for (std::size_t i = 0; i < kOutputs; ++i) to_[i] = share < 1 ? from[i] + share * (to[i] - from[i]) : to[i];
  line_ = span;
  placed_ = true;
}

void ChannelStrip::rescale(Frame now, double ratio) {
  const auto rescale = [&](Ramp& ramp) {
    ramp.begin = rescaled(ramp.begin, now, ratio);
    ramp.end = rescaled(ramp.end, now, ratio);
  };
  for (Ramp* ramp : {&gain_, &left_, &right_}) rescale(*ramp);
  for (Ramp& ramp : encoded_) rescale(ramp);
}

double ChannelStrip::max_gain() const REALTIME { return std::max(std::abs(gain_.from), std::abs(gain_.to)); }

bool ChannelStrip::heard(ChannelSet wanted) const REALTIME {
  return (wanted & (only(kLeft) | only(kRight) | kAllAmbisonic | (bus_ == kNoBus ? 0 : only(bus_)))) != 0;
}

ChannelStrip::Shares ChannelStrip::shares() const REALTIME {
  Shares shares{gain_.to * left_.to, gain_.to * right_.to, gain_.to};
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) shares[kFirstField + c] = gain_.to * encoded_[c].to;
  if (placed_) shares = to_;
  if (bus_ == kNoBus) shares[2] = 0;
  return shares;
}

void ChannelStrip::add_samples(const double* mono, std::size_t begin, std::size_t end, const Chunk& chunk,
                               ChannelSums& sums) const REALTIME {
  const Frame first = chunk.begin + static_cast<Frame>(begin);
  if (placed_) {
    const double per_frame = 1 / static_cast<double>(line_.end - line_.begin);
    const auto passed = static_cast<double>(chunk.begin - line_.begin);
    const auto add_line = [&](std::size_t channel, std::size_t i) REALTIME {
      if (!contains(chunk.wanted, channel)) return;
      if (from_[i] == to_[i]) return sums.add_samples(channel, mono, to_[i], begin, end);
      double* const out = sums.samples(channel);
      const double step = per_frame * (to_[i] - from_[i]);
      for (std::size_t n = begin; n < end; ++n)
        out[n] += (from_[i] + step * (passed + static_cast<double>(n))) * mono[n];
    };
    add_line(kLeft, 0);
    add_line(kRight, 1);
    if (bus_ != kNoBus) add_line(bus_, 2);
    if ((chunk.wanted & kAllAmbisonic) == 0) return;
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) add_line(kFirstAmbisonic + c, kFirstField + c);
    return;
  }
  const Ramp unity{1, 1};
  const auto add_to = [&](std::size_t channel, const Ramp& share) REALTIME {
    if (!contains(chunk.wanted, channel)) return;
    if (gain_.still_at(first) && share.still_at(first)) {
      return sums.add_samples(channel, mono, gain_.to * share.to, begin, end);
    }
    double* const out = sums.samples(channel);
    for (std::size_t n = begin; n < end; ++n) {
      const Frame frame = chunk.begin + static_cast<Frame>(n);
      out[n] += gain_.at(frame) * share.at(frame) * mono[n];
    }
  };
  add_to(kLeft, left_);
  add_to(kRight, right_);
  if (bus_ != kNoBus) add_to(bus_, unity);
  if ((chunk.wanted & kAllAmbisonic) == 0) return;
  for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) add_to(kFirstAmbisonic + c, encoded_[c]);
}

GainLine ChannelStrip::gain_line(std::size_t output, Frame chunk_begin) const REALTIME {
  if (!placed_) return {static_cast<float>(gain_.to * (output == 0 ? left_.to : output == 1 ? right_.to : 1)), 0};
  const double step = (to_[output] - from_[output]) / static_cast<double>(line_.end - line_.begin);
  const double middle = static_cast<double>(chunk_begin - line_.begin) + kMomentMiddle;
  return {static_cast<float>(from_[output] + step * middle), static_cast<float>(step * kMomentScale)};
}

std::span<const MomentTarget> ChannelStrip::moment_targets(
    const Chunk& chunk, ChannelSums& sums, std::array<MomentTarget, kMaxTargets>& targets) const REALTIME {
  std::size_t count = 0;
  const auto aim = [&](std::size_t channel, const GainLine& gain) REALTIME {
    if (!contains(chunk.wanted, channel)) return;
    targets[count++] = {sums.moments(channel), gain.middle, gain.slope};
  };
  constexpr ChannelSet kMix = only(kLeft) | only(kRight);
  const GainLine left = gain_line(0, chunk.begin), right = gain_line(1, chunk.begin);
  if ((chunk.wanted & kMix) == kMix && left == right) {
    targets[count++] = {sums.moments_of_both(), left.middle, left.slope};
  } else {
    aim(kLeft, left);
    aim(kRight, right);
  }
  if (bus_ != kNoBus) aim(bus_, gain_line(2, chunk.begin));
  return {targets.data(), count};
}

void ChannelStrip::add_to_field(const Chunk& chunk, FieldSums& field) const REALTIME {
  const ChannelSet wanted = chunk.wanted;
  if (contains(wanted, kLeft)) field.add_to(kLeft, gain_line(0, chunk.begin));
  if (contains(wanted, kRight)) field.add_to(kRight, gain_line(1, chunk.begin));
  if (bus_ != kNoBus && contains(wanted, bus_)) field.add_to(bus_, gain_line(2, chunk.begin));
  FieldGains gains;
  if (placed_) {
    const double per_frame = 1 / static_cast<double>(line_.end - line_.begin);
    const double middle = static_cast<double>(chunk.begin - line_.begin) + kMomentMiddle;
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      const double from = from_[kFirstField + c], step = per_frame * (to_[kFirstField + c] - from);
      gains.middle[c] = static_cast<float>(from + step * middle);
      gains.slope[c] = static_cast<float>(step * kMomentScale);
    }
    gains.moves = from_ != to_;
  } else {
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      gains.middle[c] = static_cast<float>(gain_.to) * encoded_to_[c];
    }
  }
  field.end_object(gains, wanted);
}

}  // namespace ringdown::synth
