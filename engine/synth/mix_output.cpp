#include "engine/synth/mix_output.h"

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <bit>

namespace ringdown::synth {

void MixOutput::limit(std::optional<double> ceiling_db, double sample_rate_hz) {
  limiter_.reset();
  if (ceiling_db) limiter_.emplace(sample_rate_hz, *ceiling_db);
}

void MixOutput::begin_block(const Outputs& outputs, std::size_t frames) RINGDOWN_REALTIME {
  outputs_ = outputs;
  mix_peak_ = bus_peak_ = 0;
  if (!(sound_tap.watched() || capture_tap.watched()) || frames > kMaxSpare) return;
  if (!contains(outputs.wanted(), kLeft)) outputs_.listen_to_mix(0, spare_left_.data());
  if (!contains(outputs.wanted(), kRight)) outputs_.listen_to_mix(1, spare_right_.data());
}

void MixOutput::write(const ChannelSums& sums, std::size_t at, std::size_t frames) RINGDOWN_REALTIME {
  for (ChannelSet rest = wanted(); rest != 0; rest &= rest - 1) {
    const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
    float* const out = outputs_.at(channel) + at;
    if (const double* samples = sums.result(channel)) {
      float& peak = channel < kFirstBus ? mix_peak_ : bus_peak_;
      peak = std::max(peak, write_samples(samples, out, frames));
    } else {
      std::fill_n(out, frames, 0.0f);
    }
  }
}

float MixOutput::end_block(Frame begin, std::size_t frames, double sample_rate_hz) RINGDOWN_REALTIME {
  const auto side = [this](std::size_t channel)
                        RINGDOWN_REALTIME { return contains(wanted(), channel) ? outputs_.at(channel) : nullptr; };
  float* const left = side(kLeft);
  float* const right = side(kRight);
  float mix = test_tone.add(left, right, frames, sample_rate_hz).value_or(mix_peak_);
  if (limiter_) mix = limiter_->process(left, right, frames);
  for (SoundTap* const tap : {&sound_tap, &capture_tap}) {
    if (left && right && tap->watched()) tap->put(begin, sample_rate_hz, left, right, frames);
  }
  return std::max(mix, bus_peak_);
}

}  // namespace ringdown::synth
