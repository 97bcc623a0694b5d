// Counters of the mixer, from its start on.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// Numbers that any thread may read while the mixer runs.
struct MixerCounters {
  std::atomic<std::int64_t> frames{0};           // rendered so far; also the time of the next block's first frame
  std::atomic<std::uint64_t> strikes{0};         // strikes played
  std::atomic<std::uint64_t> late{0};            // events that arrived after their frame
  std::atomic<std::uint64_t> refused{0};         // strikes on objects that do not exist, and values that are not finite
  std::atomic<std::uint64_t> limited{0};         // strikes weakened on thin objects (blow_limit.h)
  std::atomic<std::uint64_t> not_finite{0};      // times that sound was silenced for being not finite or absurd
  std::atomic<std::uint32_t> ringing_voices{0};  // in the last block
  std::atomic<std::uint32_t> ringing_modes{0};   // in the last block
  std::atomic<std::uint32_t> muted_modes{0};     // modes left out in the last block for lack of time
  std::atomic<std::uint32_t> coupled_voices{0};  // voices whose modes exchanged energy in the last block
  std::atomic<float> psi_over_truth{1};          // value farthest from 1 among these voices (coupled_modes.h)
  std::atomic<std::uint64_t> shed{0};            // chunks in which something was left out or delayed for lack of time
  std::atomic<float> peak{0};                    // largest |sample| of the last block
  std::atomic<float> peak_since{0};              // largest |sample| since Meters::take_peak()
};

inline void count(std::atomic<std::uint64_t>& counter, std::size_t times = 1) REALTIME {
  if (times > 0) counter.fetch_add(times, std::memory_order_relaxed);
}

}  // namespace ringdown::synth
