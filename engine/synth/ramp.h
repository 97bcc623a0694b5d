// A value that moves linearly from one frame to another, independent of how the time between is cut into blocks. [any]
#pragma once

#include "engine/base/realtime.h"
#include "protocol/event.h"

namespace ringdown::synth {

struct Ramp {
  double from = 0, to = 0;
  protocol::Frame begin = 0, end = 0;

  [[nodiscard]] double at(protocol::Frame frame) const RINGDOWN_REALTIME {
    if (frame >= end) return to;
    if (frame <= begin) return from;
    return from + (to - from) * (static_cast<double>(frame - begin) / static_cast<double>(end - begin));
  }
  [[nodiscard]] bool still_at(protocol::Frame frame) const RINGDOWN_REALTIME { return frame >= end; }
  void aim(double target, protocol::Frame now, protocol::Frame length) RINGDOWN_REALTIME {
    *this = {at(now), target, now, now + length};
  }
};

}  // namespace ringdown::synth
