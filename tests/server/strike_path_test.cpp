// What a strike costs the thread that receives it: from the message to the mixer's ring it takes no lock, asks the
// system for nothing, and allocates nothing but what reading the message takes.
#include "engine/modal/bank_file.h"
#include "protocol/schema.h"
#include "server/session/session.h"
#include "tests/support/realtime_guard.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace ringdown::session {
namespace {

const std::string kName = "a-name-that-no-string-holds-without-allocating";

class CountingObserver final : public Observer {
 public:
  void played(const synth::Event&) override { ++events; }
  void changed(const ObjectState*, const ObjectState*, synth::Frame) override {}
  std::size_t events = 0;
};

class StrikePathTest : public testing::Test {
 protected:
  StrikePathTest() {
    session_.rack().observers().add(observer_);
    EXPECT_TRUE(modal::write_bank(test::random_bank(1, 8, 12), folder_ / "a.glb"));
    EXPECT_TRUE(session_.rack().load(kName, folder_ / "a.glb"));
  }

  test::RealtimeViolations seen_when_read(const wire::Message& message) {
    const test::RealtimeScope scope;
    const auto request = protocol::parse(message);
    EXPECT_TRUE(request);
    return scope.seen();
  }

  test::RealtimeViolations seen_when_played(const wire::Message& message) {
    const test::RealtimeScope scope;
    auto request = protocol::parse(message);
    const auto lane = protocol::in_its_lane(*std::move(request));
    played_ = session_.play(lane.get<protocol::MixerRequest>(), 0).has_value();
    return scope.seen();
  }

  test::TemporaryFolder folder_;
  CountingObserver observer_;
  Session session_{48000};
  bool played_ = false;
};

TEST_F(StrikePathTest, AStrikeLocksNothingAndAllocatesOnlyWhatItsMessageTakes) {
  if (!test::kRealtimeGuardWorks) GTEST_SKIP() << "sanitizers and clang replace the watched functions";
  const std::vector<wire::Message> messages = {
      {"/object/" + kName + "/strike", {0.1, 0.0, 0.0, 0.0, 0.0, 0.1}},
      {"/object/0/strike", {0.1, 0.0, 0.0, 0.0, 0.0, 0.1}},
      {"/object/" + kName + "/strike_vertex", {3, 0.0, 0.0, 0.1}},
      {"/object/" + kName + "/click", {0.0, 0.0, 0.1}},
      {"/object/" + kName + "/ring", {0}},
      {"/object/" + kName + "/contact", {0.1, 0.0, 0.0, 0.0, 0.0, -1.0, 0.1}},
      {"/object/" + kName + "/clear", {}},
  };
  for (const wire::Message& message : messages) {
    seen_when_played(message);  // tables are built, and the list of events gets its room
    ASSERT_TRUE(played_) << message.address;
    const test::RealtimeViolations read = seen_when_read(message), all = seen_when_played(message);
    EXPECT_EQ(all.locks, 0u) << message.address;
    EXPECT_EQ(all.system_calls, 0u) << message.address;
    EXPECT_EQ(all.allocations, read.allocations) << message.address;
  }
  EXPECT_EQ(observer_.events, 0u) << "observers are not the striking thread's to call";
  session_.rack().observers().report_events();
  EXPECT_EQ(observer_.events, 2 * messages.size());
}

TEST_F(StrikePathTest, FindingAnObjectCostsNothingThatIsCounted) {
  if (!test::kRealtimeGuardWorks) GTEST_SKIP() << "sanitizers and clang replace the watched functions";
  const protocol::ObjectRef by_name{.name = kName}, by_number{.number = 0};
  const test::RealtimeScope scope;
  const bool found = session_.rack().find(by_name).has_value() && session_.rack().find(by_number).has_value();
  const test::RealtimeViolations seen = scope.seen();
  EXPECT_TRUE(found);
  EXPECT_EQ(seen.total(), 0u) << seen.first;
}

}  // namespace
}  // namespace ringdown::session
