// Converts between times and frames, by reading the audio driver's clock and the computer's together from time to time.
//
// A reading is a pair (time, frame). The scheduler may put milliseconds between its two halves, and JACK's own estimate
// of the frame jitters. Each reading therefore keeps the tightest of a few pairs, and the difference of the clocks is
// averaged over half a second. A jump is accepted after three readings in a row; its cause may be an xrun or a new
// server.
//
//   FrameClock clock(driver_clock(*driver), steady_now_s);
//   clock.measure();                                   // at least every 0.1 s or so
//   const synth::Frame frame = clock.frame_at(steady_now_s() + 0.25);
//
// [one thread]
#pragma once

#include "engine/synth/events/event.h"
#include "server/driver.h"

#include <functional>

namespace ringdown::server {

double steady_now_s();  // a clock that is never set
double unix_now_s();    // seconds since 1970

// The computer's clocks; tests pass their own.
struct Clocks {
  std::function<double()> steady_s = steady_now_s, unix_s = unix_now_s;
};

class FrameClock {
 public:
  struct Source {
    std::function<synth::Frame()> now;  // the frame that is being computed at this instant
    std::function<double()> rate_hz;
  };
  FrameClock(Source source, std::function<double()> seconds);

  static constexpr double kMeasureEvery_s = 0.02;

  // Reads both clocks, unless the last reading is less than kMeasureEvery_s old.
  void measure();

  [[nodiscard]] synth::Frame frame_at(double time_s) const;
  [[nodiscard]] double time_of(synth::Frame frame) const;

 private:
  struct Reading {
    double time_s, first_s;  // time of the count; time of frame 0 by that count
  };
  [[nodiscard]] Reading read() const;

  Source source_;
  std::function<double()> seconds_;
  double rate_hz_ = 0;
  double first_s_ = 0;  // time of frame 0
  double measured_s_ = 0;
  int readings_ = 0, jumps_ = 0;
};

// The driver must outlive the source.
FrameClock::Source driver_clock(const Driver& driver);

}  // namespace ringdown::server
