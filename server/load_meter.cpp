#include "server/load_meter.h"

#include <algorithm>
#include <cmath>

namespace ringdown::server {

TRUST_REALTIME_BEGIN
LoadMeter::Clock::time_point LoadMeter::clock_now() REALTIME { return Clock::now(); }
TRUST_REALTIME_END

void LoadMeter::begin(std::size_t frames, double sample_rate_hz) REALTIME {
  begin_ = now_();
  period_s_ = static_cast<double>(frames) / sample_rate_hz;
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(period_s_));
  due_.store((begin_ + period).time_since_epoch().count(), std::memory_order_relaxed);
}

void LoadMeter::end(bool deadline) REALTIME {
  constexpr double kWindow_s = 5;
  due_.store(Clock::duration::max().count(), std::memory_order_relaxed);
  if (!(period_s_ > 0)) return;
  const double load = std::chrono::duration<double>(now_() - begin_).count() / period_s_;
  if (load > 1 && deadline) misses_.fetch_add(1, std::memory_order_relaxed);
  const double weight = std::min(period_s_, 1.0);  // an exponential mean over one second
  mean_.store(mean_.load(std::memory_order_relaxed) * (1 - weight) + load * weight, std::memory_order_relaxed);
  if (load > peak_.load(std::memory_order_relaxed)) peak_.store(load, std::memory_order_relaxed);

  std::size_t filling = filling_.load(std::memory_order_relaxed);
  if ((filled_s_ += period_s_) > kWindow_s) {
    filled_s_ = 0;
    filling = 1 - filling;
    for (auto& count : histograms_[filling]) count.store(0, std::memory_order_relaxed);
    filling_.store(filling, std::memory_order_relaxed);
  }
  const double bin = std::log(std::max(load, kLowest) / kLowest) / std::log(kStep);
  const auto place = static_cast<std::size_t>(std::min(bin, static_cast<double>(kBins - 1)));
  histograms_[filling][place].fetch_add(1, std::memory_order_relaxed);
}

void LoadMeter::note_xrun() {
  const std::int32_t misses = misses_.load(std::memory_order_relaxed);
  const bool late_now = now_().time_since_epoch().count() > due_.load(std::memory_order_relaxed);
  // A callback that is late now will be counted among the misses when it ends. It must not be counted twice.
  const std::int32_t known = misses_at_xrun_.exchange(misses + (late_now ? 1 : 0), std::memory_order_relaxed);
  xruns_.fetch_add(1, std::memory_order_relaxed);
  if (late_now || misses > known) own_xruns_.fetch_add(1, std::memory_order_relaxed);
}

void LoadMeter::note_skipped(double seconds) REALTIME {
  skipped_s_.store(skipped_s_.load(std::memory_order_relaxed) + seconds, std::memory_order_relaxed);
}

void LoadMeter::note_stall(double seconds) {
  xruns_.fetch_add(1, std::memory_order_relaxed);
  note_skipped(seconds);
}

Driver::Load LoadMeter::read() const {
  std::array<std::uint64_t, kBins> counts{};
  std::uint64_t all = 0;
  for (const Histogram& histogram : histograms_) {
    for (std::size_t i = 0; i < kBins; ++i) {
      const std::uint32_t count = histogram[i].load(std::memory_order_relaxed);
      counts[i] += count;
      all += count;
    }
  }
  std::uint64_t above = 0;
  std::size_t bin = kBins;
  while (bin > 0 && (above += counts[bin - 1]) * 100 <= all) --bin;
  const double peak = peak_.load(std::memory_order_relaxed);
  const double p99 = all == 0 ? 0 : kLowest * std::pow(kStep, static_cast<double>(bin));  // the bin's upper edge
  return {.mean = mean_.load(std::memory_order_relaxed),
          .p99 = std::min(p99, peak),
          .peak = peak,
          .misses = misses_.load(std::memory_order_relaxed),
          .xruns = xruns_.load(std::memory_order_relaxed),
          .own_xruns = own_xruns_.load(std::memory_order_relaxed),
          .skipped_s = skipped_s_.load(std::memory_order_relaxed)};
}

}  // namespace ringdown::server
