// Whether there is time: what a block may take, what work costs, and what has been used.
//
// Work is counted in units: about what a mode costs in moments. What a unit takes is learnt from chunk to chunk,
// quickly when it is more than thought and slowly when it is less, so that a machine that is disturbed has less to do
// at once and more again only when it has been quiet for a while. A block's time is shared out among its chunks.
#pragma once

#include "engine/base/realtime.h"

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class Budget {
 public:
  // Both real-time safe, and called by the mixer's helpers too.
  struct Clock {
    std::int64_t (*now_ns)() RINGDOWN_REALTIME;                // from anywhere on
    void (*worked)(double units) RINGDOWN_REALTIME = nullptr;  // for clocks that count work: so much has been done
  };
  // CLOCK_MONOTONIC, which Linux reads without a system call.
  static std::int64_t now_ns() RINGDOWN_REALTIME;

  // What may be used of the time that a block lasts, 0 ... 1; 0, as in the beginning: no limit. [any thread]
  void set_share(double share) { share_.store(share, std::memory_order_relaxed); }
  void set_clock(Clock clock) { clock_ = clock; }  // for tests [worker, while nothing is rendered]

  // The rest: [audio]
  // With `deadline` false the block has all the time it wants.
  void open_block(std::size_t frames, double sample_rate_hz, bool deadline) RINGDOWN_REALTIME;
  void open_chunk(std::size_t frames) RINGDOWN_REALTIME;
  void close_chunk(double units) RINGDOWN_REALTIME;  // that were worked

  [[nodiscard]] bool limited() const RINGDOWN_REALTIME { return limited_; }
  // Units that there is time for in this chunk; and in one that nothing has disturbed.
  [[nodiscard]] double affordable() const RINGDOWN_REALTIME { return affordable_; }
  [[nodiscard]] double usual() const RINGDOWN_REALTIME { return usual_; }
  // Whether there is no time left in this chunk for so many units. [also the mixer's helpers]
  [[nodiscard]] bool over(double units) const RINGDOWN_REALTIME {
    return limited_ && clock_.now_ns() + static_cast<std::int64_t>(units * unit_ns_) > chunk_end_ns_;
  }
  void worked(double units) const RINGDOWN_REALTIME {  // [also the mixer's helpers]
    if (clock_.worked) clock_.worked(units);
  }

 private:
  std::atomic<double> share_{0};
  Clock clock_{now_ns};
  bool limited_ = false;
  static constexpr double kTypical_ns = 2;
  double unit_ns_ = kTypical_ns, took_before_ns_ = 0;
  int learnt_ = 0;
  double frame_ns_ = 0;  // of a block's time, for each of its frames
  double affordable_ = 0, usual_ = 0;
  std::int64_t deadline_ns_ = 0, chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
  std::size_t frames_left_ = 0;  // of the block
};

}  // namespace ringdown::synth
