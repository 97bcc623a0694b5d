// Turns ambisonic channels into the signals at a head's two ears: one convolution for each channel and ear, whatever
// the number of sources. The filters run without block latency, so they add no delay beyond their own.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/kernels/ambisonics.h"
#include "engine/synth/kernels/channel_sums.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace ringdown::synth {

// Impulse responses from each ambisonic channel to the left ear and to the right one, at one sample rate.
struct HeadFilters {
  std::size_t taps = 0;                        // taps of each filter
  std::array<std::vector<float>, 2> reversed;  // per ear: kMaxAmbisonicChannels x taps, the last tap first
};

// Returns the filters of a head for a sample rate; null means stereo. [worker]
using HeadLoader = std::function<std::shared_ptr<const HeadFilters>(double sample_rate_hz)>;

class Binaural {
 public:
  explicit Binaural(std::shared_ptr<const HeadFilters> head);  // [worker]

  // Returns the signals at both ears for the next chunk, <= kChunkFrames frames, from the ambisonic channels in `sums`.
  // Returns null if nothing has sounded for as long as the filters ring. The result is valid until the next call.
  // [audio]
  std::array<const double*, 2> process(const ChannelSums& sums, std::size_t frames) REALTIME;

 private:
  std::shared_ptr<const HeadFilters> head_;
  std::size_t room_;            // samples per channel: the filters' past, and a chunk
  std::vector<float> samples_;  // kMaxAmbisonicChannels x room_
  std::array<std::array<double, kChunkFrames>, 2> ears_{};
  std::array<std::size_t, kMaxAmbisonicChannels> silent_{};  // frames since the channel last had input
};

}  // namespace ringdown::synth
