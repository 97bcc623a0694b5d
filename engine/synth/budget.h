// Whether there is time: what a block may take, what work costs, and what has been used.
//
// Work is counted in units: about what a mode costs in moments. What a unit takes is learnt from chunk to chunk,
// quickly when it is more than thought and slowly when it is less, so that a machine that is disturbed has less to do
// at once and more again only when it has been quiet for a while. A block's time is shared out among its chunks.
//
// What goes on when hardly anything sounds is not counted in units but measured: coming by each item (an object or a
// family) in every chunk, and looking at modes to find out which of them matter. What that costs depends on how far
// away in memory they are. Taken for the price of units it would leave time for ever fewer of them.
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
  void open_chunk(std::size_t frames, std::size_t visits) RINGDOWN_REALTIME;  // of items, by one thread
  void close_chunk(double units) RINGDOWN_REALTIME;                           // that were worked

  [[nodiscard]] std::int64_t begin() const RINGDOWN_REALTIME { return limited_ ? clock_.now_ns() : 0; }
  void looked(std::int64_t begin_ns, double modes) RINGDOWN_REALTIME;  // at so many since then; once in a chunk
  void visited(std::int64_t begin_ns) RINGDOWN_REALTIME;               // since then one item, which had nothing to do

  [[nodiscard]] bool limited() const RINGDOWN_REALTIME { return limited_; }
  // Units that there is time for in a chunk like this one which nothing has disturbed.
  [[nodiscard]] double usual() const RINGDOWN_REALTIME { return usual_; }
  // Modes that can be looked at in this share of a chunk's time.
  [[nodiscard]] double looks(double share) const RINGDOWN_REALTIME { return share * chunk_ns_ / look_ns_; }
  // Whether there is no time left in this chunk for so many units. [also the mixer's helpers]
  [[nodiscard]] bool over(double units) const RINGDOWN_REALTIME {
    return limited_ && clock_.now_ns() + static_cast<std::int64_t>(units * unit_ns_) > chunk_end_ns_;
  }
  void worked(double units) const RINGDOWN_REALTIME {  // [also the mixer's helpers]
    if (clock_.worked) clock_.worked(units);
  }

 private:
  static void learn(double& price_ns, double took_ns, double typical_ns) RINGDOWN_REALTIME;

  std::atomic<double> share_{0};
  Clock clock_{now_ns};
  bool limited_ = false;
  static constexpr double kTypical_ns = 2, kTypicalLook_ns = 1, kTypicalVisit_ns = 20;
  double unit_ns_ = kTypical_ns, took_before_ns_ = 0;
  double look_ns_ = kTypicalLook_ns;    // a mode
  double looking_ = 0;                  // the share of a chunk's time that went into it lately
  double visit_ns_ = kTypicalVisit_ns;  // an item
  int learnt_ = 0;
  double frame_ns_ = 0;  // of a block's time, for each of its frames
  double chunk_ns_ = 0;  // of an undisturbed chunk
  double usual_ = 0;
  std::int64_t deadline_ns_ = 0, chunk_begin_ns_ = 0, chunk_end_ns_ = 0;
  double looked_ns_ = 0, visits_ns_ = 0;  // in this chunk
  std::size_t frames_left_ = 0;           // of the block
};

}  // namespace ringdown::synth
