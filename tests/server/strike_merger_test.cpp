#include "server/session/strike_merger.h"

#include <gtest/gtest.h>

namespace ringdown::session {
namespace {

using synth::Event;
namespace verb = synth::verb;
using synth::Frame;
using Verdict = StrikeMerger::Verdict;

Event blow(Frame frame, double x = 0, synth::ObjectNumber object = 0) {
  return {.frame = frame,
          .object = object,
          .verb = verb::Strike{.point_m = {x, 0, 0}, .impulse_ns = {0, 0, 1}, .contact_time_s = 0}};
}

// A merger that has just been flooded up to its threshold.
StrikeMerger flooded() {
  StrikeMerger merger(48);
  for (std::size_t i = 0; i < StrikeMerger::kMaxUnmerged; ++i) EXPECT_EQ(merger.add(blow(1000)), Verdict::pass);
  return merger;
}

TEST(StrikeMerger, StrikesThatAreNoFloodPassUntouched) {
  StrikeMerger merger(48);
  for (Frame frame = 0; frame < 100000; ++frame) ASSERT_EQ(merger.add(blow(frame)), Verdict::pass);
  StrikeMerger off(0);
  for (int i = 0; i < 100000; ++i) ASSERT_EQ(off.add(blow(0)), Verdict::pass);
}

TEST(StrikeMerger, AFloodOfStrikesOnOnePointKeepsItsImpulse) {
  StrikeMerger merger = flooded();
  EXPECT_EQ(merger.add(blow(1001)), Verdict::held);
  for (Frame i = 0; i < 1000; ++i) EXPECT_EQ(merger.add(blow(1002 + i % 40)), Verdict::merged);
  ASSERT_EQ(merger.held().size(), 1u);
  EXPECT_EQ(merger.held()[0].verb.get<verb::Strike>().impulse_ns, (Vec3{0, 0, 1001}));
  EXPECT_EQ(merger.held()[0].frame, 1041);
}

TEST(StrikeMerger, StrikesOnOtherPointsAndObjectsStayApartAndAreBounded) {
  StrikeMerger merger = flooded();
  for (std::size_t i = 0; i < StrikeMerger::kMaxHeld; ++i) {
    EXPECT_EQ(merger.add(blow(1001, static_cast<double>(i / 2), i % 2)), Verdict::held);
  }
  EXPECT_EQ(merger.held().size(), StrikeMerger::kMaxHeld);
  EXPECT_EQ(merger.add(blow(1001, -1)), Verdict::pass) << "one past the limit";
  EXPECT_EQ(merger.add(blow(1001, 0)), Verdict::merged);
}

TEST(StrikeMerger, ANewWindowOrAnotherEventHandsOnTheStrikesHeldBack) {
  StrikeMerger merger = flooded();
  EXPECT_EQ(merger.add(blow(1001)), Verdict::held);
  EXPECT_EQ(merger.add({.frame = 1001, .verb = verb::Clear{}}), Verdict::full);
  EXPECT_EQ(merger.add(blow(1049)), Verdict::full);
  merger.clear();
  EXPECT_EQ(merger.add(blow(1050)), Verdict::pass);
}

}  // namespace
}  // namespace ringdown::session
