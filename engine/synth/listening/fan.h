// A fan that closes the mouth of a tube again and again, as in a vibraphone. [audio, after construction]
//
// What sounds out of the tube has the gain 1 - depth (1 - cos phase) / 2. How bar and tube pull each other stays as it
// is: a fan turns some 5 times a second, and a tube needs 0.1 s to follow.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/events/event.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::synth {

class Fan {
 public:
  // From frame `at` on. The depth gets there within kRamp_s, so that nothing clicks.
  void set(const verb::Fan& fan, Frame at, double sample_rate_hz) REALTIME {
    const double depth = depth_at(at, sample_rate_hz);
    const bool begins = depth == 0;
    phase_ = begins ? 0 : phase_at(at, sample_rate_hz);
    from_ = depth;
    to_ = fan.depth;
    rate_hz_ = fan.rate_hz;
    since_ = at;
    on_ = from_ > 0 || to_ > 0;
  }
  void forget() REALTIME { *this = {}; }

  [[nodiscard]] bool on() const REALTIME { return on_; }
  // Ends a fan that has stopped by frame `now`. True when it has.
  bool end(Frame now, double sample_rate_hz) REALTIME {
    if (!on_ || to_ > 0 || depth_at(now, sample_rate_hz) > 0) return false;
    on_ = false;
    return true;
  }
  [[nodiscard]] double gain(Frame at, double sample_rate_hz) const REALTIME {
    return 1 - depth_at(at, sample_rate_hz) * 0.5 * (1 - std::cos(phase_at(at, sample_rate_hz)));
  }

 private:
  static constexpr double kRamp_s = 0.02;
  [[nodiscard]] double depth_at(Frame at, double sample_rate_hz) const REALTIME {
    const double part = std::clamp(static_cast<double>(at - since_) / (kRamp_s * sample_rate_hz), 0.0, 1.0);
    return from_ + part * (to_ - from_);
  }
  [[nodiscard]] double phase_at(Frame at, double sample_rate_hz) const REALTIME {
    const double turns = rate_hz_ * static_cast<double>(at - since_) / sample_rate_hz;
    return phase_ + 2 * std::numbers::pi * (turns - std::floor(turns));
  }

  Frame since_ = 0;
  double phase_ = 0, rate_hz_ = 0, from_ = 0, to_ = 0;
  bool on_ = false;
};

}  // namespace ringdown::synth
