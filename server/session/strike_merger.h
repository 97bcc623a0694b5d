// A flood of strikes, made fewer by superposition instead of lost.
//
// A few strikes pass as they are. When more than kMaxUnmerged fall within one window, those that follow are held back,
// and each that hits a point that is already held is added to it: the impulses' sum, at the time of the last. The error
// is a shift in time of less than the window. What is held is handed on when the window is over, or when another kind
// of event comes, so that the order of things is kept. [one thread]
#pragma once

#include "engine/synth/event.h"

#include <span>
#include <vector>

namespace ringdown::session {

class StrikeMerger {
 public:
  static constexpr std::size_t kMaxUnmerged = 64;  // strikes within a window
  static constexpr std::size_t kMaxHeld = 64;      // different points at once; more pass as they are

  // A window of 0 frames merges nothing.
  explicit StrikeMerger(synth::Frame window) : window_(window) {}

  enum class Verdict {
    pass,    // it is for the mixer as it is
    held,    // kept here
    merged,  // added to one that is kept here
    full,    // the window is over: hand on held(), clear(), then this event
  };
  Verdict add(const synth::Event& event);

  [[nodiscard]] std::span<const synth::Event> held() const { return held_; }
  void clear() { held_.clear(); }

 private:
  synth::Frame window_, begin_ = 0;
  std::size_t strikes_ = 0;  // since begin_
  std::vector<synth::Event> held_;
};

}  // namespace ringdown::session
