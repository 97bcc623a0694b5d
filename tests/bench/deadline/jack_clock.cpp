#include "tests/bench/deadline/jack_clock.h"

#include <jack/jack.h>

#include <algorithm>
#include <limits>

namespace ringdown::bench {
namespace {

constexpr std::size_t kMaxCycles = 200000, kFewCycles = 10;

}  // namespace

JackClock::JackClock(const std::string& server) : cycles_(kMaxCycles) {
  client_ = jack_client_open("clock", static_cast<jack_options_t>(JackNoStartServer | JackServerName), nullptr,
                             server.c_str());
  if (!client_) return;
  rate_hz_ = jack_get_sample_rate(client_);
  jack_set_process_callback(
      client_, [](jack_nframes_t frames, void* self) { return static_cast<JackClock*>(self)->process(frames); }, this);
  jack_set_xrun_callback(
      client_, [](void* self) { return ++static_cast<JackClock*>(self)->xruns_, 0; }, this);
  jack_activate(client_);
}

JackClock::~JackClock() {
  if (client_) jack_client_close(client_);
}

int JackClock::process(std::uint32_t frames) {
  jack_nframes_t at = 0;
  jack_time_t began_us = 0, next_us = 0;
  float period_us = 0;
  const std::size_t seen = seen_;
  if (seen < cycles_.size() && jack_get_cycle_times(client_, &at, &began_us, &next_us, &period_us) == 0) {
    cycles_[seen] = {1e-6 * static_cast<double>(began_us), static_cast<double>(frames_) / rate_hz_};
    seen_ = seen + 1;
  }
  frames_ += frames;
  return 0;
}

double JackClock::strayed_s() const {
  const std::size_t begin = begin_, end = seen_;
  if (end < begin + kFewCycles || end == cycles_.size()) return std::numeric_limits<double>::infinity();
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (std::size_t i = begin; i < end; ++i) {
    const double offset_s = cycles_[i].began_s - cycles_[i].frames_s;
    min = std::min(min, offset_s);
    max = std::max(max, offset_s);
  }
  return max - min;
}

}  // namespace ringdown::bench
