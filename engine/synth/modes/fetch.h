// Asks the processor for the memory of sources that are rendered soon. A thousand objects of fifty modes take 8 MB in
// each chunk, in short arrays: the processor does not foresee which come next, and waited for them two thirds of the
// time. [audio]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>
#include <span>

namespace ringdown::synth {

class Voice;

// The parts of a source that are asked for, one after the other. Each stage reads what the stage before has asked for,
// so some sources lie between the two.
enum class FetchStage : std::size_t { source, object, voice, table, numbers };

// Asks for all cache lines of `bytes` from `from` on.
inline void fetch_range(const void* from, std::size_t bytes) REALTIME {
  constexpr std::size_t kLine = 64;
  const char* const begin = static_cast<const char*>(from);
  for (std::size_t at = 0; at < bytes; at += kLine) __builtin_prefetch(begin + at);
}

// Call before source `which` is visited: lets sources behind it fetch all stages up to `last`, for a chunk of `frames`.
// Few sources stay in the cache from chunk to chunk, and are left alone.
template <class Kind>
void fetch_ahead(std::span<Kind* const> sources, std::size_t which, FetchStage last, std::size_t frames = 0) REALTIME {
  constexpr std::size_t kFew = 32, kBetween = 2;
  if (sources.size() <= kFew) return;
  for (std::size_t stage = 0, stages = static_cast<std::size_t>(last) + 1; stage < stages; ++stage) {
    const std::size_t at = which + kBetween * (stages - stage);
    if (at >= sources.size()) continue;
    if (stage == 0) {
      fetch_range(sources[at], 1);  // not even the address of its functions is known before
    } else {
      sources[at]->fetch(static_cast<FetchStage>(stage), frames);
    }
  }
}

class VoiceFetch {
 public:
  // The stages of a voice: its members, where the numbers of its table are, and its states with the numbers that
  // moments need for a chunk of `frames`.
  static void fetch(const Voice& voice, FetchStage stage, std::size_t frames) REALTIME;
};

}  // namespace ringdown::synth
