// A thread under a flood keeps real-time priority half the time; one with little to do, always.
#include "server/realtime_share.h"

#include <gtest/gtest.h>

#include <chrono>
#include <pthread.h>
#include <thread>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

bool is_realtime() {
  int policy = 0;
  sched_param parameters{};
  pthread_getschedparam(pthread_self(), &policy, &parameters);
  return policy == SCHED_FIFO && parameters.sched_priority == 5;
}

double processor_s() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Of the thread's processor time between turns, what was used at real-time priority; and at all.
struct Used {
  double realtime_s = 0, all_s = 0, wall_s = 0;
};

template <class Work>
Used take_turns(std::chrono::milliseconds time, const Work& work) {
  Used used;
  std::thread([&] {
    RealtimeShare share;
    if (!share.set_priority(5)) return;
    const auto begin = Clock::now();
    while (Clock::now() < begin + time) {
      share.turn();
      const bool realtime = is_realtime();
      const double before = processor_s();
      work();
      const double spent = processor_s() - before;
      used.all_s += spent;
      if (realtime) used.realtime_s += spent;
    }
    used.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
    EXPECT_TRUE(share.set_priority(0));
    EXPECT_FALSE(is_realtime());
  }).join();
  return used;
}

#define SKIP_WHERE_NOT_ALLOWED(used) \
  if ((used).wall_s == 0) GTEST_SKIP() << "needs the right to real-time priority"

TEST(RealtimeShare, OfABusyThreadIsHalf) {
  const Used used = take_turns(1000ms, [] {
    for (const auto end = Clock::now() + 100us; Clock::now() < end;) {
    }
  });
  SKIP_WHERE_NOT_ALLOWED(used);
  const double periods = used.wall_s / RealtimeShare::kPeriod_s + 1;
  EXPECT_LT(used.realtime_s, periods * (RealtimeShare::kMost_s + 0.002));
  EXPECT_GT(used.realtime_s, 1.5 * RealtimeShare::kMost_s) << "and it comes back";
}

TEST(RealtimeShare, OfAThreadThatRestsIsAll) {
  const Used used = take_turns(200ms, [] { std::this_thread::sleep_for(1ms); });
  SKIP_WHERE_NOT_ALLOWED(used);
  EXPECT_EQ(used.realtime_s, used.all_s);
}

}  // namespace
}  // namespace ringdown::server
