// The mixer's meters and counters, for clients that show them. The sound does not depend on them.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"
#include "engine/synth/modes/counters.h"
#include "engine/synth/modes/mode_watch.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ringdown::synth {

class Stage;

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
  void measure(const Stage& stage, Frame now, double sample_rate_hz) REALTIME;
  // Records the largest |sample| of a block. [audio]
  void note_peak(float peak) REALTIME;

 private:
  void measure_objects(const Stage& stage, Frame now) REALTIME;
  void measure_modes(const Stage& stage, Frame now, double sample_rate_hz) REALTIME;

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
