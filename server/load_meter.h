// Measures the share of its period that an audio callback uses. Any thread may read it.
//
// A callback's load is the time that the callback takes over the duration of its frames; 1 is the whole period. The
// 99th percentile covers the last five to ten seconds and comes from a histogram with steps of 4 %.
#pragma once

#include "engine/base/realtime.h"
#include "server/driver.h"

#include <array>
#include <atomic>
#include <chrono>

namespace ringdown::server {

class LoadMeter {
 public:
  using Clock = std::chrono::steady_clock;
  using Now = Clock::time_point (*)() REALTIME;

  static Clock::time_point clock_now() REALTIME;  // Linux reads this clock without a system call

  // `now` is the clock for callbacks; tests pass their own.
  explicit LoadMeter(Now now = clock_now) : now_(now) {}

  // Call at the beginning and at the end of a callback of `frames`. Without a `deadline`, in freewheel, a long callback
  // is measured but not counted as late. [audio]
  void begin(std::size_t frames, double sample_rate_hz) REALTIME;
  void end(bool deadline = true) REALTIME;

  // Counts a cycle that the server found late. The cycle counts as ours if one of our callbacks has taken longer than
  // its period since the last call, or is doing so now. [any]
  void note_xrun();

  // Counts time for which the server did not let us render. [audio]
  void note_skipped(double seconds) REALTIME;

  // Counts a cycle that never happened: the server has not called for this long, so it is left. Nothing may be
  // rendering. [the driver's own thread]
  void note_stall(double seconds);

  [[nodiscard]] Driver::Load read() const;  // [any]

 private:
  static constexpr std::size_t kBins = 256;
  static constexpr double kLowest = 1e-3, kStep = 1.04;  // the last bin begins at 22
  using Histogram = std::array<std::atomic<std::uint32_t>, kBins>;

  Now now_;
  std::atomic<double> mean_ = 0, peak_ = 0;
  std::array<Histogram, 2> histograms_{};
  std::atomic<std::size_t> filling_ = 0;  // index of the histogram that is being filled
  double filled_s_ = 0;                   // used by the audio thread only
  double period_s_ = 0;
  std::atomic<Clock::rep> due_ = Clock::duration::max().count();  // when the running callback should end
  Clock::time_point begin_;
  std::atomic<std::int32_t> misses_ = 0, xruns_ = 0, own_xruns_ = 0, misses_at_xrun_ = 0;
  std::atomic<double> skipped_s_ = 0;
};

}  // namespace ringdown::server
