// Where the sound of objects is added up, channel by channel, one chunk at a time. [audio, after construction]
//
// A channel costs nothing in a chunk in which nobody adds to it.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/moments.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

// Some of the channels: bit c stands for channel c.
using ChannelSet = std::uint64_t;
inline constexpr std::size_t kMaxChannels = 64;

constexpr bool contains(ChannelSet set, std::size_t channel) { return (set >> channel & 1) != 0; }
constexpr ChannelSet only(std::size_t channel) { return ChannelSet{1} << channel; }

class Desk {
 public:
  // Forgets what was added before.
  void open(std::size_t frames) RINGDOWN_REALTIME;

  // What to add samples or moments of a channel to.
  double* samples(std::size_t channel) RINGDOWN_REALTIME;
  MomentSums* moments(std::size_t channel) RINGDOWN_REALTIME;

  // Adds all that was added to another of the same chunk.
  void take(const Desk& other) RINGDOWN_REALTIME;

  // Turns moments into samples, after all was added.
  void close() RINGDOWN_REALTIME;

  // Null where nothing was added.
  [[nodiscard]] const double* result(std::size_t channel) const RINGDOWN_REALTIME;

 private:
  struct Channel {
    std::array<double, kChunkFrames> samples{};
    MomentSums moments;
  };
  std::vector<Channel> channels_ = std::vector<Channel>(kMaxChannels);
  ChannelSet has_samples_ = 0, has_moments_ = 0;
  std::size_t frames_ = 0;
  MomentSynthesis synthesis_;
};

}  // namespace ringdown::synth
