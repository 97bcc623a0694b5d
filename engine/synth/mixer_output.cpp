// From the desk to the listeners: where nobody listens to the mix but somebody watches it, it is rendered all the same.
#include "engine/synth/mixer.h"

#include "engine/synth/mix_kernel.h"

#include <algorithm>
#include <bit>

namespace ringdown::synth {

// What is to be rendered when the mix is watched.
Outputs Mixer::with_tap(Outputs outputs, std::size_t frames) RINGDOWN_REALTIME {
  if (!sound_tap_.watched() || frames > kMaxSpare) return outputs;
  if (!contains(outputs.wanted(), kLeft)) outputs.listen_to_mix(0, spare_left_.data());
  if (!contains(outputs.wanted(), kRight)) outputs.listen_to_mix(1, spare_right_.data());
  return outputs;
}

void Mixer::write(const Outputs& outputs, std::size_t at, std::size_t frames, Peaks& peaks) RINGDOWN_REALTIME {
  for (ChannelSet rest = wanted_; rest != 0; rest &= rest - 1) {
    const auto c = static_cast<std::size_t>(std::countr_zero(rest));
    if (const double* samples = places_.data()[0].desk.result(c)) {
      float& peak = c < kFirstBus ? peaks.mix : peaks.buses;
      peak = std::max(peak, write_samples(samples, outputs.at(c) + at, frames));
    } else {
      std::fill_n(outputs.at(c) + at, frames, 0.0f);
    }
  }
}

// Returns the largest |sample| of all that is heard, `written` being those of what was written so far.
float Mixer::finish_mix(const Outputs& outputs, std::size_t frames, Peaks written) RINGDOWN_REALTIME {
  const auto side = [&](std::size_t channel)
                        RINGDOWN_REALTIME { return contains(wanted_, channel) ? outputs.at(channel) : nullptr; };
  float* const left = side(kLeft);
  float* const right = side(kRight);
  float mix = test_tone_.add(left, right, frames, sample_rate_hz()).value_or(written.mix);
  if (limiter_) mix = limiter_->process(left, right, frames);
  if (left && right && sound_tap_.watched()) {
    sound_tap_.put(now_ - static_cast<Frame>(frames), sample_rate_hz(), left, right, frames);
  }
  return std::max(mix, written.buses);
}

}  // namespace ringdown::synth
