#include "engine/synth/worker_pool.h"

#include <algorithm>
#include <chrono>
#include <pthread.h>
#include <sched.h>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace ringdown::synth {
namespace {

constexpr auto kSpin = std::chrono::milliseconds(20);  // after the last work: a few blocks
constexpr auto kNap = std::chrono::microseconds(500);

void pause() REALTIME {
#if defined(__SSE2__)
  _mm_pause();
#endif
}

// Asks for a real-time priority like that of JACK's own threads. Where the system refuses, the thread runs without.
void ask_for_realtime() {
  const sched_param urgent{.sched_priority = std::max(sched_get_priority_min(SCHED_FIFO), 10)};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &urgent));
}

}  // namespace

WorkerPool::WorkerPool(std::size_t helpers, std::function<void(std::size_t, std::size_t)> work)
    : work_(std::move(work)), shares_(helpers + 1) {
  for (std::size_t who = 1; who <= helpers; ++who) {
    helpers_.emplace_back([this, who](const std::stop_token& stop) { help(who, stop); });
  }
}

WorkerPool::~WorkerPool() = default;

void WorkerPool::help(std::size_t who, const std::stop_token& stop) {
  const DenormalGuard guard;
  ask_for_realtime();
  using Clock = std::chrono::steady_clock;
  for (Clock::time_point last = Clock::now() - kSpin; !stop.stop_requested();) {
    if (take_some(who)) {
      last = Clock::now();
    } else if (Clock::now() - last < kSpin) {
      for (int i = 0; i < 64; ++i) pause();
    } else {
      std::this_thread::sleep_for(kNap);
    }
  }
}

bool WorkerPool::take_some(std::size_t who) REALTIME {
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    if (take_some_of(shares_[(who + i) % shares_.size()], who)) return true;
  }
  return false;
}

// A share is one 64-bit word: the round, the end of the share and the next item in it. A thread takes the next few
// items by one fetch_add, even if others do so at the same time, and gets none if others were faster. It takes an
// eighth of the remaining items, so that the last portions are small and all threads finish at about the same time: a
// form of guided self-scheduling (Polychronopoulos & Kuck, IEEE Trans. Comput. 36, 1987).
//
// work_ was given to the constructor, whose caller promises that it is fit for the audio thread.
TRUST_REALTIME_BEGIN
bool WorkerPool::take_some_of(Share& share, std::size_t who) REALTIME {
  constexpr std::size_t kHelpings = 8;  // of what is left of a share
  const auto end_of = [](std::uint64_t word) { return static_cast<std::size_t>(word >> kItemBits & kItemMask); };
  const auto item_of = [](std::uint64_t word) { return static_cast<std::size_t>(word & kItemMask); };
  const std::uint64_t seen = share.next.load(std::memory_order_acquire);
  if (item_of(seen) >= end_of(seen)) return false;
  const std::size_t few = 1 + (end_of(seen) - item_of(seen)) / kHelpings;
  const std::uint64_t mine = share.next.fetch_add(few, std::memory_order_acq_rel);
  const std::size_t begin = item_of(mine), end = std::min(begin + few, end_of(mine));
  if (begin >= end) return false;
  for (std::size_t item = begin; item < end; ++item) work_(item, who);
  done_.fetch_add(end - begin, std::memory_order_release);
  return true;
}
TRUST_REALTIME_END

void WorkerPool::run(std::size_t count) REALTIME {
  done_.store(0, std::memory_order_relaxed);
  ++round_;
  for (std::size_t i = 0; i < shares_.size(); ++i) {
    const std::uint64_t begin = count * i / shares_.size(), end = count * (i + 1) / shares_.size();
    shares_[i].next.store(round_ << 2 * kItemBits | end << kItemBits | begin, std::memory_order_release);
  }
  while (take_some(0)) {
  }
  while (done_.load(std::memory_order_acquire) < count) pause();
}

}  // namespace ringdown::synth
