// Learns from the clock how much work fits into the time that a block may take.
//
// Work is counted in units: one unit is the cost of a mode in a chunk that is summed as moments, and every other kind
// of work is a multiple of it (work_cost.h). The time of a unit differs between machines and from moment to moment, so
// nothing is assumed about it. After each chunk the budget computes how many units would have taken kTarget of the time
// at this chunk's rate. The running mean of these answers is affordable(). Time that is not counted as units (objects
// that are only visited, other programs) makes the answers smaller, but they converge: if F is such time, p the price
// of a unit and t the target, W units take F + p W, and the next answer t W / (F + p W) leads to F + p W = t.
//
// One audio thread; const functions are called by its helpers too.
#pragma once

#include "engine/base/realtime.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

// CLOCK_MONOTONIC, which Linux reads without a system call. [any]
std::int64_t monotonic_ns() REALTIME;

// The clock of the budget. Both functions are real-time safe, and are also called by the helper threads.
struct WorkClock {
  std::int64_t (*now_ns)() REALTIME = monotonic_ns;  // from any origin
  void (*worked)(double units) REALTIME = nullptr;   // for clocks that count work: reports the units done
};

class TimeBudget {
 public:
  // Share of the time that affordable() units take.
  static constexpr double kTarget = 0.97;

  // Sets the share of a block's time that may be used, 0 ... 1; 0: no limit. [worker, while nothing is rendered]
  void configure(double share, WorkClock clock) {
    share_ = share;
    clock_ = clock;
  }

  // All functions below: [audio]

  // Begins a block. Without a deadline the block's time is unlimited.
  void begin_block(std::size_t frames, double sample_rate_hz, bool deadline) REALTIME;
  void begin_chunk(std::size_t frames) REALTIME;
  void begin_rendering() REALTIME;
  void end_chunk(double units) REALTIME;  // units worked since begin_chunk()

  [[nodiscard]] bool limited() const REALTIME { return limited_; }
  // Returns the units that take kTarget of the time of a chunk like this one, without disturbance.
  [[nodiscard]] double affordable() const REALTIME { return affordable_ * chunk_share_; }
  // Returns the units that one of `threads` threads can still do in this chunk's time, having done `done` since
  // begin_rendering(): at the learnt price, or at the price of this chunk if that is higher.
  [[nodiscard]] double units_left(double done, std::size_t threads) const REALTIME;
  void worked(double units) const REALTIME {
    if (clock_.worked) clock_.worked(units);
  }

 private:
  double share_ = 0;
  WorkClock clock_;
  bool limited_ = false;
  double affordable_ = 0;   // units per kChunkFrames frames
  double chunk_share_ = 1;  // this chunk's frames over kChunkFrames
  double frame_ns_ = 0;     // block time per frame
  double chunk_ns_ = 0;     // time of an undisturbed chunk
  double doubted_ = 0;      // an answer far below affordable_ that is not confirmed yet; 0: none
  int lessons_ = 0;
  std::int64_t deadline_ns_ = 0, chunk_begin_ns_ = 0, chunk_end_ns_ = 0, render_begin_ns_ = 0;
  std::size_t frames_left_ = 0;  // frames left in the block
};

}  // namespace ringdown::synth
