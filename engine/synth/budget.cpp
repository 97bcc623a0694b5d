#include "engine/synth/budget.h"

#include <algorithm>
#include <ctime>
#include <utility>

namespace ringdown::synth {
namespace {

constexpr double kLearnUp = 0.3, kLearnDown = 0.03;
constexpr double kMostSurprise = 2;  // a chunk in which the thread did not run says little of what work costs
constexpr double kLeastUnits = 500;  // less work tells nothing

}  // namespace

// glibc's clock_gettime reads the vDSO's page here: no system call.
RINGDOWN_TRUST_REALTIME_BEGIN
std::int64_t Budget::now_ns() RINGDOWN_REALTIME {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}
RINGDOWN_TRUST_REALTIME_END

void Budget::open_block(std::size_t frames, double sample_rate_hz, bool deadline) RINGDOWN_REALTIME {
  const double share = share_.load(std::memory_order_relaxed);
  limited_ = share > 0 && deadline;
  if (!limited_) return;
  frames_left_ = frames;
  deadline_ns_ =
      clock_.now_ns() + static_cast<std::int64_t>(share * 1e9 * static_cast<double>(frames) / sample_rate_hz);
}

void Budget::open_chunk(std::size_t frames) RINGDOWN_REALTIME {
  if (!limited_) return;
  chunk_begin_ns_ = clock_.now_ns();
  const double left_ns = static_cast<double>(std::max<std::int64_t>(deadline_ns_ - chunk_begin_ns_, 0));
  const double ours_ns = left_ns * static_cast<double>(frames) / static_cast<double>(std::max(frames_left_, frames));
  chunk_end_ns_ = chunk_begin_ns_ + static_cast<std::int64_t>(ours_ns);
  affordable_ = ours_ns / unit_ns_;
  frames_left_ -= std::min(frames, frames_left_);
}

void Budget::close_chunk(double units) RINGDOWN_REALTIME {
  if (!limited_ || units < kLeastUnits) return;
  const double took_ns = static_cast<double>(clock_.now_ns() - chunk_begin_ns_) / units;
  if (!std::exchange(has_learnt_, true)) unit_ns_ = took_ns;
  const double change = std::min(took_ns, kMostSurprise * unit_ns_) - unit_ns_;
  unit_ns_ = std::max(unit_ns_ + (change > 0 ? kLearnUp : kLearnDown) * change, 0.01);
}

}  // namespace ringdown::synth
