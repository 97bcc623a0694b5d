#include "engine/synth/output/binaural.h"

#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/mix_kernel.h"

#include <algorithm>
#include <utility>

namespace ringdown::synth {

Binaural::Binaural(std::shared_ptr<const HeadFilters> head)
    : head_(std::move(head)),
      room_(head_->taps - 1 + kChunkFrames + kFilterOverrun),
      samples_(kMaxAmbisonicChannels * room_, 0.0f) {
  silent_.fill(head_->taps);
}

std::array<const double*, 2> Binaural::process(const ChannelSums& sums, std::size_t frames) REALTIME {
  const std::size_t past = head_->taps - 1;
  std::array<float, kChunkFrames + kFilterOverrun> left{}, right{};
  bool heard = false;
  for (std::size_t channel = 0; channel < kMaxAmbisonicChannels; ++channel) {
    float* const samples = samples_.data() + channel * room_;
    const double* const now = sums.result(kFirstAmbisonic + channel);
    silent_[channel] = now ? 0 : std::min(silent_[channel] + frames, head_->taps + kChunkFrames);
    if (silent_[channel] >= head_->taps + frames) continue;  // its past is silent, too
    for (std::size_t n = 0; n < frames; ++n) samples[past + n] = now ? static_cast<float>(now[n]) : 0.0f;
    add_filtered(samples, head_->taps, {head_->reversed[0].data() + channel * head_->taps, left.data()},
                 {head_->reversed[1].data() + channel * head_->taps, right.data()}, frames);
    std::copy_n(samples + frames, past, samples);
    heard = true;
  }
  if (!heard) return {nullptr, nullptr};
  std::copy_n(left.data(), frames, ears_[0].data());
  std::copy_n(right.data(), frames, ears_[1].data());
  return {ears_[0].data(), ears_[1].data()};
}

}  // namespace ringdown::synth
