#include "engine/synth/output/mix_output.h"

#include "engine/synth/kernels/mix_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace ringdown::synth {

void MixOutput::limit(std::optional<double> ceiling_db, double sample_rate_hz) {
  limiter_.reset();
  if (ceiling_db) limiter_.emplace(sample_rate_hz, *ceiling_db);
}

void MixOutput::wear(std::shared_ptr<const HeadFilters> head) {
  binaural_.reset();
  if (head) binaural_.emplace(std::move(head));
}

ChannelSet MixOutput::to_render() const REALTIME {
  constexpr ChannelSet kMix = only(kLeft) | only(kRight);
  return binaural_ && (wanted() & kMix) != 0 ? (wanted() & ~kMix) | kAllAmbisonic : wanted();
}

void MixOutput::begin_block(const Outputs& outputs, std::size_t frames) REALTIME {
  outputs_ = &outputs;
  mix_peak_ = bus_peak_ = pickup_peak_ = 0;
  if (!tapped() || frames > kMaxSpare) return;
  with_spare_ = outputs;
  if (!contains(outputs.wanted(), kLeft)) with_spare_.listen_to_mix(0, spare_left_.data());
  if (!contains(outputs.wanted(), kRight)) with_spare_.listen_to_mix(1, spare_right_.data());
  outputs_ = &with_spare_;
}

// Only a chunk in which nothing is added is longer than kChunkFrames; what a head's filters still hold is heard in it.
void MixOutput::write(const ChannelSums& sums, std::size_t at, std::size_t frames) REALTIME {
  for (std::size_t done = 0; done < frames; done += kChunkFrames) {
    write_piece(sums, at + done, std::min(frames - done, kChunkFrames));
  }
}

void MixOutput::write_piece(const ChannelSums& sums, std::size_t at, std::size_t frames) REALTIME {
  std::array<const double*, 2> mix = {sums.result(kLeft), sums.result(kRight)};
  if (binaural_) mix = binaural_->process(sums, frames);
  for (ChannelSet rest = wanted(); rest != 0; rest &= rest - 1) {
    const auto channel = static_cast<std::size_t>(std::countr_zero(rest));
    float* const out = outputs_->at(channel) + at;
    if (const double* samples = channel < kFirstBus ? mix[channel] : sums.result(channel)) {
      float& peak = channel < kFirstBus ? mix_peak_ : is_pickup(channel) ? pickup_peak_ : bus_peak_;
      peak = std::max(peak, write_samples(samples, out, frames));
    } else {
      std::fill_n(out, frames, 0.0f);
    }
  }
}

float MixOutput::end_block(Frame begin, std::size_t frames, double sample_rate_hz) REALTIME {
  const auto side = [this](std::size_t channel)
                        REALTIME { return contains(wanted(), channel) ? outputs_->at(channel) : nullptr; };
  float* const left = side(kLeft);
  float* const right = side(kRight);
  const bool spoilt = std::isinf(std::max(std::max(mix_peak_, bus_peak_), pickup_peak_));
  float mix = mix_peak_;
  if (!test_tone.off()) mix = test_tone.add(left, right, frames, sample_rate_hz).value_or(mix);
  if (limiter_) mix = limiter_->process(left, right, frames);
  if (tapped() && left && right) {
    for (SoundTap* const tap : {&sound_tap, &capture_tap}) {
      if (tap->watched()) tap->put(begin, sample_rate_hz, left, right, frames);
    }
  }
  return spoilt ? std::numeric_limits<float>::infinity() : std::max(mix, bus_peak_);
}

}  // namespace ringdown::synth
