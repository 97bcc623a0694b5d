// The time budget alone: what it learns, and when there is no time left.
#include "engine/synth/objects/time_budget.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/fake_clock.h"

#include <gtest/gtest.h>

namespace ringdown::synth::test {
namespace {

constexpr std::int64_t kBlock_ns = 1'000'000;  // of 128 frames at 128 kHz
constexpr double kRate_hz = 128e3, kShare = 0.5;
constexpr double kTime_ns = kShare * kBlock_ns;

// Chunks of 128 frames in which `units` are worked and `other_ns` pass besides.
void run_chunks(TimeBudget& budget, int chunks, double units, double other_ns = 0) {
  for (int i = 0; i < chunks; ++i) {
    budget.begin_block(128, kRate_hz, true);
    budget.begin_chunk(128);
    budget.worked(units);
    fake_now_ns += static_cast<std::int64_t>(other_ns);
    budget.end_chunk(units);
  }
}

TEST(TimeBudget, TheBudgetLearnsHowMuchWorkFitsIntoAChunk) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  run_chunks(budget, 200, 20000);
  EXPECT_NEAR(budget.affordable(), TimeBudget::kTarget * kTime_ns / 10, 500);
}

TEST(TimeBudget, TheBudgetSharesABlockAmongItsChunks) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  run_chunks(budget, 200, 20000);
  budget.begin_block(512, kRate_hz, true);
  budget.begin_chunk(128);
  EXPECT_NEAR(budget.units_left(0, 1), kTime_ns / 10, 500);
  EXPECT_NEAR(budget.units_left(0, 2), 0.5 * kTime_ns / 10, 250) << "of one of two threads";
  fake_now_ns += static_cast<std::int64_t>(kTime_ns) + 1;
  EXPECT_EQ(budget.units_left(0, 1), 0);
  budget.begin_chunk(128);
  EXPECT_NEAR(budget.units_left(0, 1), kTime_ns / 10, 500) << "the others have theirs";
}

TEST(TimeBudget, TheBudgetKnowsThePriceOfTheChunkAtHand) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  run_chunks(budget, 200, 20000);
  fake_unit_ns = 30;
  budget.begin_block(128, kRate_hz, true);
  budget.begin_chunk(128);
  budget.begin_rendering();
  budget.worked(5000);
  EXPECT_NEAR(budget.units_left(5000, 1), (kTime_ns - 5000 * 30) / 30, 100);
}

// If time that is not counted in units were charged to the units, the estimate would fall chunk by chunk, down to none.
TEST(TimeBudget, UncountedTimeLeavesTheRestForWork) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  const double other_ns = 0.4 * kTime_ns;
  double units = 40000;
  for (int i = 0; i < 300; ++i) {
    run_chunks(budget, 1, units, other_ns);
    units = budget.affordable();
  }
  EXPECT_NEAR(units * 10 + other_ns, TimeBudget::kTarget * kTime_ns, 0.02 * kTime_ns);
}

TEST(TimeBudget, OneStandstillOfTheMachineChangesTheBudgetLittle) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  run_chunks(budget, 200, 20000);
  const double before = budget.affordable();
  run_chunks(budget, 1, 20000, 100 * kTime_ns);
  EXPECT_GT(budget.affordable(), 0.9 * before);
  run_chunks(budget, 20, 20000, 3 * kTime_ns);
  EXPECT_LT(budget.affordable(), 0.4 * before) << "but many do";
}

TEST(TimeBudget, TheBudgetRecoversWhenThereIsHardlyAnythingToDo) {
  TimeBudget budget;
  fake_unit_ns = 10;
  budget.configure(kShare, kFake);
  run_chunks(budget, 50, 20000, 100 * kTime_ns);
  ASSERT_LT(budget.affordable(), 1000);
  run_chunks(budget, 1000, 10);
  EXPECT_GT(budget.affordable(), 20000);
}

TEST(TimeBudget, BlocksWithoutAShareOrADeadlineHaveNoLimit) {
  for (const double share : {0.0, 0.5}) {
    TimeBudget budget;
    budget.configure(share, kFake);
    budget.begin_block(128, kRate_hz, share == 0);
    EXPECT_FALSE(budget.limited());
  }
}

TEST(TimeBudget, TheBudgetReadsItsClockWithoutASystemCall) {
  const ringdown::test::RealtimeScope scope;
  EXPECT_GT(monotonic_ns(), 0);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
