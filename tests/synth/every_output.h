// All the outputs that a mixer has, at once: left and right, buses and ambisonic channels, as they would go to a sound
// card, with every sample looked at.
#pragma once

#include "engine/synth/mixer.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace ringdown::synth::test {

class EveryOutput {
 public:
  static constexpr std::size_t kFrames = 1024;  // of a block, at most

  // Renders a block of `frames` and returns how many of its samples, in all channels, are not finite.
  std::size_t render(Mixer& mixer, std::size_t frames, const Inputs& inputs = {}) {
    Outputs outputs(at(kLeft), at(kRight));
    for (std::size_t bus = 0; bus < kMaxBuses; ++bus) outputs.listen_to_bus(bus, at(kFirstBus + bus));
    const auto& settings = mixer.settings();
    const std::size_t ambisonic = settings.ambisonic_order ? ambisonic_channels(*settings.ambisonic_order) : 0;
    for (std::size_t acn = 0; acn < ambisonic; ++acn) outputs.listen_to_ambisonics(acn, at(kFirstAmbisonic + acn));
    mixer.render(outputs, inputs, frames);
    std::size_t not_finite = 0;
    for (std::size_t channel = 0; channel < kFirstAmbisonic + ambisonic; ++channel) {
      for (std::size_t n = 0; n < frames; ++n) {
        not_finite += !std::isfinite(at(channel)[n]);
        loud_ = loud_ || at(channel)[n] != 0;
      }
    }
    return not_finite;
  }

  // Whether any sample since the last call was not silent.
  bool take_loud() { return std::exchange(loud_, false); }

 private:
  float* at(std::size_t channel) { return samples_.data() + channel * kFrames; }

  std::vector<float> samples_ = std::vector<float>(kMaxChannels * kFrames);
  bool loud_ = false;
};

}  // namespace ringdown::synth::test
