#include "engine/synth/objects/time_budget.h"

#include "engine/synth/kernels/mode_kernel.h"

#include <ctime>

namespace ringdown::synth {
namespace {

constexpr double kTypical_ns = 2;   // time of a unit before anything was measured
constexpr double kMinUnits = 500;   // less work says little about the price of a unit
constexpr double kLearn = 0.25;     // weight of an answer in the running mean
constexpr double kLearnFull = 0.5;  // weight of an answer from a chunk that used up its time
constexpr int kFirstLessons = 10;   // number of first answers, none of which is dismissed
constexpr double kRecover = 1.03;   // growth of the mean per chunk with little work
constexpr double kMaxChange = 4;    // largest factor between an answer and the mean, up or down
constexpr double kDoubted = 0.8;    // an answer below this share of the mean must be confirmed by the next one
constexpr double kMinAffordable = 1;
constexpr double kMinPace = 0.05;  // of affordable(): after less work the price of this chunk is not known

}  // namespace

// glibc's clock_gettime reads the vDSO's page here: no system call.
TRUST_REALTIME_BEGIN
std::int64_t monotonic_ns() REALTIME {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}
TRUST_REALTIME_END

void TimeBudget::begin_block(std::size_t frames, double sample_rate_hz, bool deadline) REALTIME {
  limited_ = share_ > 0 && deadline;
  if (!limited_) return;
  frames_left_ = frames;
  frame_ns_ = share_ * 1e9 / sample_rate_hz;
  deadline_ns_ = clock_.now_ns() + static_cast<std::int64_t>(frame_ns_ * static_cast<double>(frames));
  if (lessons_ == 0) affordable_ = kTarget * frame_ns_ * static_cast<double>(kChunkFrames) / kTypical_ns;
}

// A chunk gets a share, by frames, of the time left until the block's deadline. So gains and losses of earlier chunks
// are spread over all remaining ones.
void TimeBudget::begin_chunk(std::size_t frames) REALTIME {
  if (!limited_) return;
  chunk_begin_ns_ = render_begin_ns_ = clock_.now_ns();
  const double left_ns = static_cast<double>(std::max<std::int64_t>(deadline_ns_ - chunk_begin_ns_, 0));
  const double ours_ns = left_ns * static_cast<double>(frames) / static_cast<double>(std::max(frames_left_, frames));
  chunk_end_ns_ = chunk_begin_ns_ + static_cast<std::int64_t>(ours_ns);
  chunk_ns_ = frame_ns_ * static_cast<double>(frames);
  chunk_share_ = static_cast<double>(frames) / static_cast<double>(kChunkFrames);
  frames_left_ -= std::min(frames, frames_left_);
}

void TimeBudget::begin_rendering() REALTIME {
  if (limited_) render_begin_ns_ = clock_.now_ns();
}

double TimeBudget::units_left(double done, std::size_t threads) const REALTIME {
  const std::int64_t now_ns = clock_.now_ns();
  const double mine = affordable() / static_cast<double>(threads);
  double price_ns = kTarget * chunk_ns_ / std::max(mine, kMinAffordable);
  if (done > kMinPace * mine) price_ns = std::max(price_ns, static_cast<double>(now_ns - render_begin_ns_) / done);
  return static_cast<double>(std::max<std::int64_t>(chunk_end_ns_ - now_ns, 0)) / price_ns;
}

// Each chunk that did enough work gives an answer: the units that would have taken kTarget of its time, at its own
// price per unit. affordable_ is the running mean of these answers: at first the plain mean, from the fourth on an
// exponential one, with twice the weight for a chunk that used up its time, since being late is worse than being
// careful. An answer may change the mean by a factor of kMaxChange at most.
//
// A machine that pauses for a moment says little about the cost of work, so an answer that is much smaller than the
// mean counts only if the next one confirms it.
void TimeBudget::end_chunk(double units) REALTIME {
  if (!limited_) return;
  if (units < kMinUnits * chunk_share_) {
    const double typical = kTarget * frame_ns_ * static_cast<double>(kChunkFrames) / kTypical_ns;
    affordable_ = std::max(affordable_, std::min(kRecover * affordable_, typical));
    return;
  }
  const double took_ns = std::max(static_cast<double>(clock_.now_ns() - chunk_begin_ns_), 1.0);
  const double used = took_ns / chunk_ns_;
  double answer = kTarget * units / used / chunk_share_;
  const double before = doubted_;
  doubted_ = lessons_ > 0 && answer < kDoubted * affordable_ ? answer : 0;
  const bool confirmed = doubted_ == 0 || before > 0;
  if (!confirmed) answer = kDoubted * affordable_;
  // Time that is not counted as units makes the answer too small if there was time left, and too large if there was
  // none. Such an answer says nothing about affordable().
  if (lessons_ == kFirstLessons && (used > kTarget) == (answer > affordable_)) return;
  if (lessons_ > 0) answer = std::clamp(answer, affordable_ / kMaxChange, affordable_ * kMaxChange);
  const double weight =
      std::max(confirmed && used > kTarget ? kLearnFull : kLearn, 1 / static_cast<double>(lessons_ + 1));
  affordable_ = std::max(affordable_ + weight * (answer - affordable_), kMinAffordable);
  lessons_ = std::min(lessons_ + 1, kFirstLessons);
}

}  // namespace ringdown::synth
