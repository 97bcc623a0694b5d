// The time budget alone: what it learns of prices, and when a chunk is over.
#include "engine/synth/budget.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/fake_clock.h"

#include <gtest/gtest.h>

namespace ringdown::synth::test {
namespace {

constexpr std::int64_t kBlock_ns = 1'000'000;  // of 100 frames at 100 kHz

TEST(Budget, LearnsWhatWorkCostsAndSharesABlockAmongItsChunks) {
  Budget budget;
  fake_unit_ns = 10;
  budget.set_clock(kFake);
  budget.set_share(0.5);
  for (int block = 0; block < 200; ++block) {
    budget.open_block(100, 1e5, true);
    for (int chunk = 0; chunk < 4; ++chunk) {
      budget.open_chunk(25, 0);
      budget.worked(10000);
      budget.close_chunk(10000);
    }
  }
  budget.open_block(100, 1e5, true);
  budget.open_chunk(25, 0);
  EXPECT_NEAR(budget.usual(), 0.5 * kBlock_ns / 4 / 10, 50);
  EXPECT_FALSE(budget.over(12000));
  EXPECT_TRUE(budget.over(13000));
  fake_now_ns += kBlock_ns / 8 + 1;
  EXPECT_TRUE(budget.over(0));
  budget.open_chunk(25, 0);
  EXPECT_FALSE(budget.over(0)) << "the other chunks share what is left";
  EXPECT_NEAR(budget.usual(), 0.5 * kBlock_ns / 4 / 10, 50);
}

// A small scene on a machine that now and then takes some time for itself: it is to cost what it costs on average, not
// what it does at worst.
TEST(Budget, DisturbancesOfChunksThatDoLittleAreNoAlarm) {
  constexpr double kUnit_ns = 10, kUnits = 1000, kDisturbance_ns = 30000, kChunk_ns = 0.5 * kBlock_ns;
  fake_unit_ns = kUnit_ns;
  Budget budget;
  budget.set_clock(kFake);
  budget.set_share(0.5);
  for (int block = 0; block < 2000; ++block) {
    budget.open_block(100, 1e5, true);
    budget.open_chunk(100, 0);
    budget.worked(kUnits);
    if (block % 4 < 2) fake_now_ns += static_cast<std::int64_t>(kDisturbance_ns);  // twice on end, so it is believed
    budget.close_chunk(kUnits);
  }
  const double average_ns = kUnit_ns + 0.5 * kDisturbance_ns / kUnits;
  EXPECT_GE(budget.usual(), 0.9 * kChunk_ns / average_ns);
  EXPECT_LE(budget.usual(), kChunk_ns / kUnit_ns);
}

TEST(Budget, BlocksWithoutALimitOrADeadlineAreNeverOver) {
  for (const double share : {0.0, 0.5}) {
    Budget budget;
    budget.set_clock(kFake);
    budget.set_share(share);
    budget.open_block(100, 1e5, share == 0);
    budget.open_chunk(100, 0);
    fake_now_ns += 1000 * kBlock_ns;
    EXPECT_FALSE(budget.limited());
    EXPECT_FALSE(budget.over(0));
  }
}

TEST(Budget, ReadsItsClockWithoutASystemCall) {
  const ringdown::test::RealtimeScope scope;
  EXPECT_GT(Budget::now_ns(), 0);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
