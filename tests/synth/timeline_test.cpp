// How a block is cut, and the levels by which modes are muted.
#include "engine/synth/modes/level_histogram.h"
#include "engine/synth/events/timeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace ringdown::synth::test {
namespace {

TEST(Timeline, TheTimelineCutsAtTheNextCommandAndAtMostAChunkAhead) {
  Timeline timeline(16);
  EXPECT_EQ(timeline.chunk_frames(0, 1000, false, false), kChunkFrames);
  EXPECT_EQ(timeline.chunk_frames(0, 50, false, false), 50u);
  ASSERT_TRUE(timeline.push(Command{.kind = Command::Kind::remove, .object = 1, .at = 30}));
  EXPECT_EQ(timeline.chunk_frames(0, 1000, false, false), 30u);
  EXPECT_EQ(timeline.due_command(29), nullptr);
  ASSERT_NE(timeline.due_command(30), nullptr);
  EXPECT_EQ(timeline.due_command(30)->object, 1u);
}

TEST(Timeline, SilenceIsRenderedInOneGoUntilSomethingHappens) {
  Timeline timeline(16);
  EXPECT_EQ(timeline.chunk_frames(0, 1000, true, false), 1000u);
  ASSERT_TRUE(timeline.push(Producer::control, Event{.frame = 999}));
  timeline.events().accept(0, [](const Event&) {});
  EXPECT_EQ(timeline.chunk_frames(0, 1000, true, false), kChunkFrames);
  EXPECT_EQ(timeline.chunk_frames(0, 999, true, false), 999u);
}

TEST(Timeline, ChunksInCellsEndAtMultiplesOfAChunkWhereverBlocksBegin) {
  Timeline timeline(16);
  for (const Frame begin : {Frame{0}, Frame{1}, Frame{64}, Frame{127}, Frame{1'000'000'007}}) {
    const auto frames = static_cast<Frame>(timeline.chunk_frames(begin, 1000, false, true));
    EXPECT_EQ((begin + frames) % static_cast<Frame>(kChunkFrames), 0) << begin;
    EXPECT_LE(frames, static_cast<Frame>(kChunkFrames)) << begin;
  }
  EXPECT_EQ(timeline.chunk_frames(100, 20, false, true), 20u);
  EXPECT_EQ(timeline.chunk_frames(100, 1000, true, true), 1000u) << "silence";
}

TEST(Timeline, ALaterCommandWaitsForTheOneBeforeIt) {
  Timeline timeline(16);
  ASSERT_TRUE(timeline.push(Command{.kind = Command::Kind::assign, .object = 1, .at = 100}));
  ASSERT_TRUE(timeline.push(Command{.kind = Command::Kind::assign, .object = 2, .at = 0}));
  EXPECT_EQ(timeline.due_command(50), nullptr);
  timeline.pop_command();
  EXPECT_EQ(timeline.due_command(50)->object, 2u);
}

// Within an octave the steps are even in energy, not in its logarithm: that makes up to 0.26 dB.
TEST(Level, LevelsAreProportionalToDecibels) {
  for (double db = -160; db < 40; db += 0.37) {
    EXPECT_NEAR(level_of(std::pow(10.0, 0.1 * db)) * kStep_db, db, kStep_db + 0.26);
  }
}

TEST(Level, ALevelThatIsNotANumberLiesAboveEverything) {
  EXPECT_GT(level_of(std::nan("")), level_of(1e30));
  EXPECT_GT(level_of(-std::nan("")), level_of(1e30));
  EXPECT_GT(level_of(HUGE_VAL), level_of(1e30));
}

// Against a sorted list.
TEST(LevelHistogram, TheThresholdLeavesAsManyModesAsAreWantedAndNoMore) {
  std::mt19937 random(1);
  LevelHistogram histogram;
  std::vector<Level> levels;
  for (int i = 0; i < 5000; ++i) {
    levels.push_back(static_cast<Level>(random() % 300) - 250);
    histogram.add(levels.back());
  }
  constexpr Level kAll = -100000;
  EXPECT_EQ(histogram.threshold_for(8 * 5000.0, kAll), kAll);
  for (const double wanted : {0.0, 100.0, 4000.0, 20000.0, 39000.0}) {
    const Level threshold = histogram.threshold_for(wanted, kAll);
    const auto above = [&](Level from) {
      return 8.0 * static_cast<double>(
                       std::count_if(levels.begin(), levels.end(), [from](Level level) { return level >= from; }));
    };
    EXPECT_LE(above(threshold), wanted);
    EXPECT_GT(above(threshold - 1), wanted) << "no higher than need be";
    EXPECT_EQ(static_cast<double>(histogram.modes_from(threshold)), above(threshold));
  }
}

}  // namespace
}  // namespace ringdown::synth::test
