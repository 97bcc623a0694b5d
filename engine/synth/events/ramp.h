// A value that moves linearly from one frame to another, independent of how the time between is cut into blocks. [any]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"

#include <cmath>

namespace ringdown::synth {

struct Ramp {
  double from = 0, to = 0;
  Frame begin = 0, end = 0;

  [[nodiscard]] double at(Frame frame) const REALTIME {
    if (frame >= end) return to;
    if (frame <= begin) return from;
    return from + (to - from) * (static_cast<double>(frame - begin) / static_cast<double>(end - begin));
  }
  [[nodiscard]] bool still_at(Frame frame) const REALTIME { return frame >= end; }
  void aim(double target, Frame now, Frame length) REALTIME { *this = {at(now), target, now, now + length}; }
};

// Converts a frame after a change of the sample rate at frame `now`: it comes `ratio` times as many frames after `now`.
inline Frame rescaled(Frame frame, Frame now, double ratio) {
  return now + static_cast<Frame>(std::llround(static_cast<double>(frame - now) * ratio));
}

}  // namespace ringdown::synth
