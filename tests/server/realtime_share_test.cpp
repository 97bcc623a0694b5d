// A thread under a flood keeps real-time priority half the time; one with little to do, always. The clocks and the
// scheduler are the test's own.
#include "server/realtime_share.h"

#include <gtest/gtest.h>

#include <pthread.h>
#include <thread>

namespace ringdown::server {
namespace {

struct FakeSystem {
  double now_s = 100, used_s = 7;
  int priority = 0, calls = 0;
  bool allows = true;
} fake;

constexpr RealtimeShare::System kFake = {[] { return fake.now_s; }, [] { return fake.used_s; },
                                         [](int priority) {
                                           ++fake.calls;
                                           if (!fake.allows) return 1;
                                           fake.priority = priority;
                                           return 0;
                                         }};

// Of the thread's processor time between turns, what was used at real-time priority; and at all.
struct Used {
  double realtime_s = 0, all_s = 0;
};

// A turn every 0.1 ms, of which the thread works for `load`.
Used take_turns(RealtimeShare& share, double seconds, double load) {
  constexpr double kTurn_s = 1e-4;
  Used used;
  for (const double end_s = fake.now_s + seconds; fake.now_s < end_s; fake.now_s += kTurn_s) {
    share.turn();
    fake.used_s += load * kTurn_s;
    used.all_s += load * kTurn_s;
    if (fake.priority > 0) used.realtime_s += load * kTurn_s;
  }
  return used;
}

TEST(RealtimeShare, ABusyThreadHasRealtimePriorityHalfTheTime) {
  fake = {};
  RealtimeShare share(kFake);
  ASSERT_TRUE(share.set_priority(5));
  const Used used = take_turns(share, 10, 1);
  EXPECT_NEAR(used.all_s, 10, 0.001);
  EXPECT_NEAR(used.realtime_s, 5, 0.4) << "it looks every 0.5 ms whether 10 of 20 ms are used";
  EXPECT_TRUE(share.set_priority(0));
  EXPECT_EQ(fake.priority, 0);
}

TEST(RealtimeShare, AThreadThatRestsHalfTheTimeKeepsRealtimePriority) {
  fake = {};
  RealtimeShare share(kFake);
  ASSERT_TRUE(share.set_priority(5));
  const Used used = take_turns(share, 10, 0.49);
  EXPECT_EQ(used.realtime_s, used.all_s);
  EXPECT_EQ(fake.calls, 1) << "and the system is not asked again";
}

TEST(RealtimeShare, RealtimePriorityComesBackAsSoonAsTheFloodIsOver) {
  fake = {};
  RealtimeShare share(kFake);
  ASSERT_TRUE(share.set_priority(5));
  take_turns(share, 0.015, 1);
  EXPECT_EQ(fake.priority, 0);
  take_turns(share, RealtimeShare::kPeriod_s, 0.1);
  EXPECT_EQ(fake.priority, 5);
}

TEST(RealtimeShare, AThreadThatMayNotHaveRealtimePriorityAsksOnce) {
  fake = {.allows = false};
  RealtimeShare share(kFake);
  EXPECT_FALSE(share.set_priority(5));
  take_turns(share, 1, 1);
  EXPECT_EQ(fake.calls, 1) << "it is not asked for again and again";
}

TEST(RealtimeShare, RealtimePriorityIsThatOfTheThreadItself) {
  bool allowed = false;
  int policy = -1, left = -1;
  sched_param parameters{};
  std::thread([&] {
    RealtimeShare share;
    allowed = share.set_priority(5).has_value();
    pthread_getschedparam(pthread_self(), &policy, &parameters);
    EXPECT_TRUE(share.set_priority(0));
    sched_param none{};
    pthread_getschedparam(pthread_self(), &left, &none);
  }).join();
  if (!allowed) GTEST_SKIP() << "needs the right to real-time priority";
  EXPECT_EQ(policy, SCHED_FIFO);
  EXPECT_EQ(parameters.sched_priority, 5);
  EXPECT_EQ(left, SCHED_OTHER);
}

}  // namespace
}  // namespace ringdown::server
