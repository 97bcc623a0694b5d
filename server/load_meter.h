// How much of its time an audio callback uses: measured there, read anywhere.
#pragma once

#include "server/driver.h"

#include <algorithm>
#include <atomic>
#include <chrono>

namespace ringdown::server {

class LoadMeter {
 public:
  using Clock = std::chrono::steady_clock;

  // After a callback of `frames` that began at `begin`. [audio]
  void note(Clock::time_point begin, std::size_t frames, double sample_rate_hz) {
    const double available_s = static_cast<double>(frames) / sample_rate_hz;
    const double load = std::chrono::duration<double>(Clock::now() - begin).count() / available_s;
    const double weight = std::min(available_s, 1.0);  // an exponential mean over one second
    mean_.store(mean_.load(std::memory_order_relaxed) * (1 - weight) + load * weight, std::memory_order_relaxed);
    if (load > peak_.load(std::memory_order_relaxed)) peak_.store(load, std::memory_order_relaxed);
  }

  [[nodiscard]] Driver::Load read() const {
    return {mean_.load(std::memory_order_relaxed), peak_.load(std::memory_order_relaxed)};
  }

 private:
  std::atomic<double> mean_ = 0, peak_ = 0;
};

}  // namespace ringdown::server
