#include "server/frame_clock.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace ringdown::server {
namespace {

constexpr int kTries = 4;
constexpr double kTight_s = 10e-6;  // at most between the two halves of a good reading
constexpr double kAverage_s = 0.5;  // time constant of the average
constexpr double kJump_s = 2e-3;    // a larger difference is not jitter
constexpr int kJumpsToBelieve = 3;

template <class Clock>
double now_s() {
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

}  // namespace

double steady_now_s() { return now_s<std::chrono::steady_clock>(); }
double unix_now_s() { return now_s<std::chrono::system_clock>(); }

FrameClock::Source driver_clock(const Driver& driver) {
  return {[&driver] { return driver.now(); }, [&driver] { return driver.sample_rate_hz(); }};
}

FrameClock::FrameClock(Source source, std::function<double()> seconds)
    : source_(std::move(source)), seconds_(std::move(seconds)) {
  measure();
}

FrameClock::Reading FrameClock::read() const {
  Reading best{};
  double tightest_s = 0;
  for (int i = 0; i < kTries && (i == 0 || tightest_s > kTight_s); ++i) {
    const double before_s = seconds_();
    const auto frame = static_cast<double>(source_.now()) + 0.5;  // now() counts whole frames
    const double after_s = seconds_();
    if (i > 0 && after_s - before_s >= tightest_s) continue;
    tightest_s = after_s - before_s;
    const double time_s = 0.5 * (before_s + after_s);
    best = {time_s, time_s - frame / rate_hz_};
  }
  return best;
}

void FrameClock::measure() {
  const double now = seconds_();
  if (readings_ > 0 && now - measured_s_ < kMeasureEvery_s) return;
  if (const double rate = source_.rate_hz(); rate != rate_hz_) {
    rate_hz_ = rate;
    readings_ = 0;
  }
  const Reading reading = read();
  const double off_s = reading.first_s - first_s_;
  const bool jumped = readings_ > 0 && std::abs(off_s) > kJump_s;
  jumps_ = jumped ? jumps_ + 1 : 0;
  if (jumped && jumps_ < kJumpsToBelieve) {
    measured_s_ = now;
    return;
  }
  if (jumped || readings_ == 0) {
    first_s_ = reading.first_s;
    readings_ = jumps_ = 0;
  } else {
    first_s_ += off_s * std::clamp((now - measured_s_) / kAverage_s, 1.0 / (readings_ + 1), 1.0);
  }
  ++readings_;
  measured_s_ = now;
}

synth::Frame FrameClock::frame_at(double time_s) const { return std::llround((time_s - first_s_) * rate_hz_); }

double FrameClock::time_of(synth::Frame frame) const { return first_s_ + static_cast<double>(frame) / rate_hz_; }

}  // namespace ringdown::server
