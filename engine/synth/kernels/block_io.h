// The buffers of a block: output channels to write, and audio inputs to read. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/ambisonics.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// Channels: left and right of the mix, the buses, the pickups, and ambisonic channels.
inline constexpr std::size_t kMaxChannels = 64;
inline constexpr std::size_t kLeft = 0, kRight = 1, kFirstBus = 2;
inline constexpr std::size_t kFirstAmbisonic = kMaxChannels - kMaxAmbisonicChannels;
inline constexpr std::size_t kMaxPickups = 8;  // pickups of a mixer, each with a channel of its own
inline constexpr std::size_t kFirstPickup = kFirstAmbisonic - kMaxPickups;
constexpr bool is_pickup(std::size_t channel) { return channel >= kFirstPickup && channel < kFirstAmbisonic; }
inline constexpr std::size_t kNoBus = 0;  // means no bus where a bus's channel is expected

// A set of channels: bit c stands for channel c.
using ChannelSet = std::uint64_t;
constexpr bool contains(ChannelSet set, std::size_t channel) { return (set >> channel & 1) != 0; }
constexpr ChannelSet only(std::size_t channel) { return ChannelSet{1} << channel; }
// The first `count` ambisonic channels.
constexpr ChannelSet ambisonic_set(std::size_t count) { return ((ChannelSet{1} << count) - 1) << kFirstAmbisonic; }
inline constexpr ChannelSet kAllAmbisonic = ambisonic_set(kMaxAmbisonicChannels);

// The output buffers of a block. A channel without a buffer is not rendered.
class Outputs {
 public:
  Outputs() = default;
  Outputs(float* left, float* right) REALTIME { listen(kLeft, left), listen(kRight, right); }
  void listen_to_mix(std::size_t side, float* samples) REALTIME { listen(side, samples); }  // 0 left, 1 right
  void listen_to_bus(std::size_t bus, float* samples) REALTIME { listen(kFirstBus + bus, samples); }
  void listen_to_pickup(std::size_t pickup, float* samples) REALTIME { listen(kFirstPickup + pickup, samples); }
  void listen_to_ambisonics(std::size_t acn, float* samples) REALTIME { listen(kFirstAmbisonic + acn, samples); }

  [[nodiscard]] ChannelSet wanted() const REALTIME { return wanted_; }
  [[nodiscard]] float* at(std::size_t channel) const REALTIME { return samples_[channel]; }

 private:
  void listen(std::size_t channel, float* samples) REALTIME {
    samples_[channel] = samples;
    wanted_ |= only(channel);
  }
  std::array<float*, kMaxChannels> samples_;  // valid for wanted channels only
  ChannelSet wanted_ = 0;
};

// Audio inputs that excite objects: for each input null, or one sample per frame.
inline constexpr std::size_t kMaxInputs = 4;
using Inputs = std::array<const float*, kMaxInputs>;

}  // namespace ringdown::synth
