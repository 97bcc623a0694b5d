// Reduces a flood of strikes by superposition, so that none is lost.
//
// The first kMaxUnmerged strikes of a window pass unchanged. Later strikes are held back. A strike on the point of a
// held strike is added to that strike, which then has the sum of the impulses and the time of the last. The error is a
// shift in time of less than the window. Held strikes are handed on when the window is over or when an event of another
// kind comes, so that events keep their order. [one thread]
#pragma once

#include "engine/synth/events/event.h"

#include <span>
#include <vector>

namespace ringdown::session {

class StrikeMerger {
 public:
  static constexpr std::size_t kMaxUnmerged = 64;  // strikes within a window
  static constexpr std::size_t kMaxHeld = 64;      // different points at once; strikes on further points pass unchanged

  // A window of 0 frames merges nothing.
  explicit StrikeMerger(synth::Frame window) : window_(window) {}

  enum class Verdict {
    pass,    // the event goes to the mixer unchanged
    held,    // the event is held here
    merged,  // the event was added to a held event
    full,    // the window is over: hand on held(), call clear(), then hand on this event
  };
  Verdict add(const synth::Event& event);

  [[nodiscard]] std::span<const synth::Event> held() const { return held_; }
  void clear() { held_.clear(); }

 private:
  synth::Frame window_, begin_ = 0;
  std::size_t strikes_ = 0;  // number of strikes since begin_
  std::vector<synth::Event> held_;
};

}  // namespace ringdown::session
