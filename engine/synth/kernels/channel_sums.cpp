#include "engine/synth/kernels/channel_sums.h"

#include "engine/synth/kernels/mix_kernel.h"

#include <algorithm>
#include <array>
#include <bit>

namespace ringdown::synth {
namespace {

void add_moments(const MomentSums& from, MomentSums& to) REALTIME {
  for (std::size_t i = 0; i < to.of.size(); ++i) to.of[i] += from.of[i];
}

}  // namespace

void ChannelSums::open(std::size_t frames) REALTIME {
  has_samples_ = has_moments_ = 0;
  has_both_ = false;
  frames_ = frames;
  if (field_) field_->open();
}

// The first sound of a whole chunk is written, which saves setting the channel to zero.
void ChannelSums::add_samples(std::size_t channel, const double* mono, double gain, std::size_t begin,
                              std::size_t end) REALTIME {
  if (!contains(has_samples_, channel) && begin == 0 && end == frames_) {
    has_samples_ |= only(channel);
    return write_scaled(mono, gain, channels_[channel].samples.data(), end);
  }
  add_scaled(mono + begin, gain, samples(channel) + begin, end - begin);
}

double* ChannelSums::samples(std::size_t channel) REALTIME {
  Channel& c = channels_[channel];
  if (!contains(has_samples_, channel)) std::fill_n(c.samples.data(), frames_, 0.0);
  has_samples_ |= only(channel);
  return c.samples.data();
}

MomentSums* ChannelSums::moments(std::size_t channel) REALTIME {
  Channel& c = channels_[channel];
  if (!contains(has_moments_, channel)) c.moments.of.fill(0);
  has_moments_ |= only(channel);
  return &c.moments;
}

MomentSums* ChannelSums::moments_of_both() REALTIME {
  if (!has_both_) both_->of.fill(0);
  has_both_ = true;
  return both_.get();
}

void ChannelSums::add(const ChannelSums& other) REALTIME {
  if (other.has_both_) add_moments(*other.both_, *moments_of_both());
  for (std::size_t c = 0; c < kMaxChannels; ++c) {
    if (!contains(other.has_samples_ | other.has_moments_, c)) continue;
    const Channel& from = other.channels_[c];
    if (contains(other.has_samples_, c)) add_scaled(from.samples.data(), 1, samples(c), frames_);
    if (!contains(other.has_moments_, c)) continue;
    add_moments(from.moments, *moments(c));
  }
  if (field_ && other.field_) field_->add(*other.field_);
}

// A complex transform turns the moments of two channels at once.
void ChannelSums::close() REALTIME {
  std::array<double, kChunkFrames> unused;
  if (has_both_ && (has_moments_ & (only(kLeft) | only(kRight))) == 0) {
    synthesis_.add(*both_, *both_, samples(kLeft), samples(kRight), frames_);
  } else if (has_both_) {
    for (const std::size_t channel : {kLeft, kRight}) add_moments(*both_, *moments(channel));
  }
  for (ChannelSet rest = has_moments_; rest != 0;) {
    const auto take = [&rest]() REALTIME {
      const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
      rest &= rest - 1;
      return channel;
    };
    const std::size_t first = take();
    const bool alone = rest == 0;
    const std::size_t second = alone ? first : take();
    if (alone) unused.fill(0);
    synthesis_.add(channels_[first].moments, channels_[second].moments, samples(first),
                   alone ? unused.data() : samples(second), frames_);
  }
  if (!field_ || field_->channels() == 0) return;
  std::array<double*, kMaxChannels> out{};
  for (ChannelSet rest = field_->channels(); rest != 0; rest &= rest - 1) {
    const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
    out[channel] = samples(channel);
  }
  field_->close(out, frames_);
}

const double* ChannelSums::result(std::size_t channel) const REALTIME {
  return contains(has_samples_, channel) ? channels_[channel].samples.data() : nullptr;
}

}  // namespace ringdown::synth
