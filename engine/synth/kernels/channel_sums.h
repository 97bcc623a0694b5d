// The sum of all objects' sound in each channel, for one chunk at a time. [audio, after construction]
//
// A channel costs nothing in a chunk in which nothing is added to it.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/block_io.h"
#include "engine/synth/kernels/field_sums.h"
#include "engine/synth/kernels/moments.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace ringdown::synth {

class ChannelSums {
 public:
  // Allocates or frees the ambisonic channels. [worker, while nothing is rendered]
  void have_field(bool on) { field_ = on ? std::make_unique<FieldSums>() : nullptr; }

  // Must come before anything is added. [worker]
  void make_room() {
    if (!channels_.empty()) return;
    channels_ = std::vector<Channel>(kMaxChannels);
    both_ = std::make_unique<MomentSums>();
  }

  // Begins a chunk of `frames` and drops earlier sums. More than kChunkFrames only if nothing is added.
  void open(std::size_t frames) REALTIME;

  // Adds `gain` times the samples of frames begin ... end - 1 to a channel; mono[begin] is the first.
  void add_samples(std::size_t channel, const double* mono, double gain, std::size_t begin, std::size_t end) REALTIME;
  // Return the samples or moments of a channel, to which callers add.
  double* samples(std::size_t channel) REALTIME;
  MomentSums* moments(std::size_t channel) REALTIME;
  // Returns moments that sound alike in the left and the right channel, both of which must be wanted: an object in the
  // middle is added once.
  MomentSums* moments_of_both() REALTIME;
  // Returns the sums that take an object for all of its channels together; null if there are no ambisonic channels.
  [[nodiscard]] FieldSums* field() REALTIME { return field_.get(); }

  // Adds the sums of `other` for the present chunk.
  void add(const ChannelSums& other) REALTIME;

  // Turns moments into samples, after everything was added.
  void close() REALTIME;

  // Returns the channel's samples; null if nothing was added.
  [[nodiscard]] const double* result(std::size_t channel) const REALTIME;

 private:
  struct Channel {
    alignas(64) std::array<double, kChunkFrames> samples{};
    MomentSums moments;
  };
  std::vector<Channel> channels_;
  ChannelSet has_samples_ = 0, has_moments_ = 0;
  std::unique_ptr<MomentSums> both_;  // of left and right alike
  bool has_both_ = false;
  std::size_t frames_ = 0;
  std::unique_ptr<FieldSums> field_;
  MomentSynthesis synthesis_;
};

}  // namespace ringdown::synth
