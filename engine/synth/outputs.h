// Where the mixer writes. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/desk.h"

#include <array>
#include <cstddef>

namespace ringdown::synth {

// Where a block is written. What nobody listens to is not rendered.
class Outputs {
 public:
  Outputs() = default;
  Outputs(float* left, float* right) RINGDOWN_REALTIME { listen(0, left), listen(1, right); }
  void listen_to_mix(std::size_t side, float* samples) RINGDOWN_REALTIME { listen(side, samples); }  // 0 left, 1 right
  void listen_to_bus(std::size_t bus, float* samples) RINGDOWN_REALTIME { listen(2 + bus, samples); }

  [[nodiscard]] ChannelSet wanted() const RINGDOWN_REALTIME { return wanted_; }
  [[nodiscard]] float* at(std::size_t channel) const RINGDOWN_REALTIME { return samples_[channel]; }

 private:
  void listen(std::size_t channel, float* samples) RINGDOWN_REALTIME {
    samples_[channel] = samples;
    wanted_ |= only(channel);
  }
  std::array<float*, kMaxChannels> samples_;  // those that are wanted
  ChannelSet wanted_ = 0;
};

}  // namespace ringdown::synth
