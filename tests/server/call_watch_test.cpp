// When a server counts as silent, by a clock that the test sets.
#include "server/call_watch.h"

#include <gtest/gtest.h>

namespace ringdown::server {
namespace {

using namespace std::chrono_literals;
using Time = CallWatch::Clock::time_point;

TEST(CallWatch, AServerThatCallsNowAndThenIsNeverSilentForLong) {
  CallWatch watch;
  std::uint64_t calls = 0;
  for (auto now = 0ms; now < 10s; now += 100ms) {
    if (now % 400ms == 0ms) calls += 2;
    EXPECT_LE(watch.look(calls, false, Time(now)), 300ms) << now.count();
  }
  EXPECT_TRUE(watch.was_called());
}

TEST(CallWatch, ASilenceGrowsFromTheLastCallOnAndEndsWithTheNext) {
  CallWatch watch;
  watch.look(6, false, Time(0ms));
  for (auto now = 100ms; now <= 1500ms; now += 100ms) EXPECT_EQ(watch.look(6, false, Time(now)), now);
  EXPECT_EQ(watch.look(8, false, Time(1600ms)), 0ms);
  EXPECT_EQ(watch.look(8, false, Time(1700ms)), 100ms);
}

TEST(CallWatch, AServerThatHasNeverCalledIsSilentFromTheFirstLookOn) {
  CallWatch watch;
  for (auto now = 0ms; now <= 1s; now += 100ms) EXPECT_EQ(watch.look(0, false, Time(now)), now);
  EXPECT_FALSE(watch.was_called());
}

TEST(CallWatch, FreewheelAndOurOwnCallbackAreNoSilence) {
  CallWatch watch;
  for (auto now = 0ms; now <= 5s; now += 100ms) EXPECT_EQ(watch.look(7, true, Time(now)), 0ms);
  EXPECT_EQ(watch.look(7, false, Time(5100ms)), 100ms);
}

// A stopped process, or a computer that slept, finds a clock that has jumped.
TEST(CallWatch, TimeInWhichNobodyLookedIsNoSilence) {
  CallWatch watch;
  watch.look(2, false, Time(0ms));
  EXPECT_LE(watch.look(2, false, Time(1h)), CallWatch::kMaxStep);
  EXPECT_LE(watch.look(2, false, Time(2h)), 2 * CallWatch::kMaxStep);
}

}  // namespace
}  // namespace ringdown::server
