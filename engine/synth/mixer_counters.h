// What the mixer counts. [any thread reads]
#pragma once

#include <atomic>
#include <cstdint>

namespace ringdown::synth {

// Numbers that any thread may read while the mixer runs.
struct MixerCounters {
  std::atomic<std::int64_t> frames{0};    // rendered so far; also the time of the next block's first frame
  std::atomic<std::uint64_t> strikes{0};  // played
  std::atomic<std::uint64_t> late{0};     // events that came after their frame
  std::atomic<std::uint64_t> refused{
      0};  // strikes on what does not exist (any more), gains and pans that are no numbers
  std::atomic<std::uint64_t> not_finite{0};      // voices silenced because a state was no longer a sensible number
  std::atomic<std::uint32_t> ringing_voices{0};  // in the last block
  std::atomic<std::uint32_t> ringing_modes{0};   // in the last block
  std::atomic<std::uint32_t> hidden_modes{0};    // left out in the last block: masked, or shed
  std::atomic<std::uint64_t> shed{0};            // chunks in which something was left out or put off for want of time
  std::atomic<float> peak{0};                    // largest |sample| of the last block
  std::atomic<float> peak_since{0};              // the same since take_peak()
};

}  // namespace ringdown::synth
