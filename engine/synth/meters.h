// The mixer's meters and counters, for clients that show them. The sound does not depend on them.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/event.h"
#include "engine/synth/modes/mode_watch.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

class Stage;

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

inline void count(std::atomic<std::uint64_t>& counter, std::size_t times = 1) RINGDOWN_REALTIME {
  if (times > 0) counter.fetch_add(times, std::memory_order_relaxed);
}

class Meters {
 public:
  MixerCounters counters;
  ModeWatch mode_watch;  // the amplitudes of some objects' modes, at their gain and before pan

  // Sets whether the objects' peak levels are measured. Costs nothing unless set; then at most 2048 modes are read in a
  // chunk, so that many objects take turns, 64 or fewer in a chunk. [any thread]
  void watch_objects(bool on) { watches_objects_.store(on, std::memory_order_relaxed); }
  // Returns an upper bound of the object's samples since the last call, at its gain, as far as measured: the sum of its
  // modes' amplitudes, which is exact for one mode. [one thread that is not audio]
  [[nodiscard]] float take_peak_level(ObjectNumber object);
  // Returns the largest |sample| since the last call. [one thread that is not audio]
  [[nodiscard]] float take_peak() { return counters.peak_since.exchange(0, std::memory_order_relaxed); }

  // Measures peak levels and amplitudes at the end of a chunk; `now` is the frame after it. [audio]
  void measure(const Stage& stage, Frame now, double sample_rate_hz) RINGDOWN_REALTIME;
  // Records the largest |sample| of a block. [audio]
  void note_peak(float peak) RINGDOWN_REALTIME;

 private:
  void measure_objects(const Stage& stage, Frame now) RINGDOWN_REALTIME;
  void measure_modes(const Stage& stage, Frame now, double sample_rate_hz) RINGDOWN_REALTIME;

  struct PeakLevel {
    std::atomic<float> now{0}, since{0};
  };
  std::atomic<bool> watches_objects_{false};
  std::vector<PeakLevel> peak_levels_ = std::vector<PeakLevel>(kMaxObjects);
  std::size_t next_object_ = 0;  // the audio thread's own, like the members below
  std::size_t next_slot_ = 0;    // next slot of mode_watch
  Frame slots_began_ = 0;        // frame at which the first slot was last written
};

}  // namespace ringdown::synth
