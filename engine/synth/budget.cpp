#include "engine/synth/budget.h"

#include <algorithm>
#include <ctime>

namespace ringdown::synth {
namespace {

// Upwards from a chunk that took all its time. In one that took little of it small disturbances are large for each
// unit: prices that rose by them would leave ever less to do, and so ever more to be disturbed.
constexpr double kLearnUp = 0.3, kLearnDown = 0.03;
constexpr int kFirstLessons = 40;  // which are averaged
// A chunk in which the thread did not run says little of what work costs: beyond kUnconfirmed only two on end are
// believed, and no more than kMaxSurprise.
constexpr double kUnconfirmed = 1.2, kMaxSurprise = 2;
constexpr double kLeast_ns = 0.01;
constexpr double kMinUnits = 500;  // less work tells only that units do not cost as much as was thought
constexpr double kMinLook = 200;   // modes
constexpr double kMaxLooking = 0.3, kMaxVisiting = 0.5;  // of a chunk's time
constexpr double kMinWorking = 0.2;                      // of what a chunk took without looking

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
  frame_ns_ = share * 1e9 / sample_rate_hz;
  deadline_ns_ = clock_.now_ns() + static_cast<std::int64_t>(frame_ns_ * static_cast<double>(frames));
}

void Budget::open_chunk(std::size_t frames, std::size_t visits) RINGDOWN_REALTIME {
  if (!limited_) return;
  chunk_begin_ns_ = clock_.now_ns();
  const double left_ns = static_cast<double>(std::max<std::int64_t>(deadline_ns_ - chunk_begin_ns_, 0));
  const double ours_ns = left_ns * static_cast<double>(frames) / static_cast<double>(std::max(frames_left_, frames));
  chunk_end_ns_ = chunk_begin_ns_ + static_cast<std::int64_t>(ours_ns);
  chunk_ns_ = frame_ns_ * static_cast<double>(frames);
  looked_ns_ = 0;
  visits_ns_ = std::min(static_cast<double>(visits) * visit_ns_, kMaxVisiting * chunk_ns_);
  usual_ = ((1 - looking_) * chunk_ns_ - visits_ns_) / unit_ns_;
  frames_left_ -= std::min(frames, frames_left_);
}

void Budget::looked(std::int64_t begin_ns, double modes) RINGDOWN_REALTIME {
  if (!limited_) return;
  looked_ns_ = static_cast<double>(clock_.now_ns() - begin_ns);
  if (modes >= kMinLook) learn(look_ns_, looked_ns_ / modes, kTypicalLook_ns);
}

void Budget::visited(std::int64_t begin_ns) RINGDOWN_REALTIME {
  if (limited_) learn(visit_ns_, static_cast<double>(clock_.now_ns() - begin_ns), kTypicalVisit_ns);
}

// Of many small times the mean counts, but not one in which the thread did not run.
void Budget::learn(double& price_ns, double took_ns, double typical_ns) RINGDOWN_REALTIME {
  const double believed_ns = std::min(took_ns, kMaxSurprise * std::max(price_ns, typical_ns));
  price_ns = std::max(price_ns + kLearnDown * (believed_ns - price_ns), kLeast_ns);
}

void Budget::close_chunk(double units) RINGDOWN_REALTIME {
  if (!limited_) return;
  looking_ += kLearnDown * (std::min(looked_ns_ / chunk_ns_, kMaxLooking) - looking_);
  const double all_ns = static_cast<double>(clock_.now_ns() - chunk_begin_ns_) - looked_ns_;
  const double took_ns = std::max(all_ns - visits_ns_, kMinWorking * all_ns) / std::max(units, kMinUnits);
  const double before_ns = unit_ns_;
  if (units < kMinUnits) {
    unit_ns_ -= kLearnDown * std::max(unit_ns_ - std::max(took_ns, kTypical_ns), 0.0);
  } else {
    const double confirmed_ns = std::min(took_ns, std::max(took_before_ns_, kUnconfirmed * unit_ns_));
    const double change = std::min(confirmed_ns, kMaxSurprise * unit_ns_) - unit_ns_;
    const double used = std::min(all_ns / chunk_ns_, 1.0);
    const double learn = change > 0 ? std::max(kLearnUp * used * used, kLearnDown) : kLearnDown;
    const double weight = std::max(learn, 1 / static_cast<double>(learnt_ + 1));
    unit_ns_ = std::max(learnt_ == 0 ? took_ns : unit_ns_ + weight * change, kLeast_ns);
    took_before_ns_ = took_ns;
    learnt_ = std::min(learnt_ + 1, kFirstLessons);
  }
  usual_ *= before_ns / unit_ns_;
}

}  // namespace ringdown::synth
