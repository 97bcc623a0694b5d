// How much work fits into the time that a block may take, learnt from the clock.
//
// Work is counted in units: one is what a mode costs in a chunk that is summed as moments, and every other kind of work
// is a multiple of it (work_cost.h). What a unit takes differs from machine to machine and from moment to moment, so
// nothing is assumed about it. After each chunk the budget asks: at this rate, how many units would have taken kTarget
// of the time? The answers' running mean is affordable(). What costs time without being counted (objects that are only
// visited, other programs) makes the answers smaller, but not ever smaller: if F is such time, p the price of a unit
// and t the target, W units take F + p W, and the next answer t W / (F + p W) leads to F + p W = t.
//
// One audio thread; const functions are called by its helpers too.
#pragma once

#include "engine/base/realtime.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// CLOCK_MONOTONIC, which Linux reads without a system call. [any]
std::int64_t monotonic_ns() RINGDOWN_REALTIME;

// The clock of the budget. Both functions are real-time safe, and called by the helper threads too.
struct WorkClock {
  std::int64_t (*now_ns)() RINGDOWN_REALTIME = monotonic_ns;  // from any origin
  void (*worked)(double units) RINGDOWN_REALTIME = nullptr;   // for clocks that count work: so much has been done
};

class TimeBudget {
 public:
  // The share of its time that affordable() units take.
  static constexpr double kTarget = 0.97;

  // Sets the share of a block's time that may be used, 0 ... 1; 0: no limit. [worker, while nothing is rendered]
  void configure(double share, WorkClock clock) {
    share_ = share;
    clock_ = clock;
  }

  // The rest: [audio]
  // Without a deadline the block has all the time it wants.
  void begin_block(std::size_t frames, double sample_rate_hz, bool deadline) RINGDOWN_REALTIME;
  void begin_chunk(std::size_t frames) RINGDOWN_REALTIME;
  void begin_rendering() RINGDOWN_REALTIME;
  void end_chunk(double units) RINGDOWN_REALTIME;  // that were worked since begin_chunk()

  [[nodiscard]] bool limited() const RINGDOWN_REALTIME { return limited_; }
  // Units that take kTarget of the time of a chunk like this one, if nothing disturbs it.
  [[nodiscard]] double affordable() const RINGDOWN_REALTIME { return affordable_ * chunk_share_; }
  // Units that one of `threads` threads can still do in this chunk's time, having done `done` since begin_rendering():
  // at the learnt price, or at the price of this chunk where that is higher.
  [[nodiscard]] double units_left(double done, std::size_t threads) const RINGDOWN_REALTIME;
  void worked(double units) const RINGDOWN_REALTIME {
    if (clock_.worked) clock_.worked(units);
  }

 private:
  double share_ = 0;
  WorkClock clock_;
  bool limited_ = false;
  double affordable_ = 0;   // in kChunkFrames frames
  double chunk_share_ = 1;  // this chunk's frames over kChunkFrames
  double frame_ns_ = 0;     // of a block's time, for each of its frames
  double chunk_ns_ = 0;     // of an undisturbed chunk
  double doubted_ = 0;      // an answer far below affordable_ that waits to be confirmed; 0: none
  int lessons_ = 0;
  std::int64_t deadline_ns_ = 0, chunk_begin_ns_ = 0, chunk_end_ns_ = 0, render_begin_ns_ = 0;
  std::size_t frames_left_ = 0;  // of the block
};

}  // namespace ringdown::synth
