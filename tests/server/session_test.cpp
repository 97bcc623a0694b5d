// Objects by name and number, and what requests do to them.
#include "engine/modal/bank_file.h"
#include "server/session.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <unistd.h>

namespace ringdown::server {
namespace {

using protocol::ObjectRef;

class SessionTest : public testing::Test {
 protected:
  SessionTest() : folder_(std::filesystem::temp_directory_path() / ("ringdown-session-" + std::to_string(::getpid()))) {
    std::filesystem::create_directory(folder_);
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "a.glb"));
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(660, 2), folder_ / "b.glb"));
  }
  ~SessionTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string bank(const std::string& name) const { return (folder_ / name).string(); }

  test::Samples render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    session_.rack().collect();
    return test::to_doubles(left);
  }

  Result<void> strike(const ObjectRef& object) {
    const auto now = session_.rack().mixer().counters().frames.load();
    return session_.play(protocol::Strike{object, {1, 0, 0}, {0, 0, 1}, 0}, now);
  }

  std::filesystem::path folder_;
  Session session_{48000};
};

TEST_F(SessionTest, ObjectsAreFoundByNameAndByTheNumberThatLoadReturned) {
  const auto number = session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0);
  ASSERT_TRUE(number && *number);
  const auto by_name = session_.rack().find({.name = "a"});
  const auto by_number = session_.rack().find({.number = static_cast<std::uint32_t>(**number)});
  ASSERT_TRUE(by_name && by_number);
  EXPECT_EQ(by_name->number, by_number->number);
  EXPECT_FALSE(session_.rack().find({.name = "b"}));
}

TEST_F(SessionTest, ANewBankTakesTheStrikesWhileTheOldOneRingsOut) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"x", bank("a.glb")}, 0));
  ASSERT_TRUE(strike({.name = "x"}));
  render(4800);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"x", bank("b.glb")}, 0));
  const auto old = test::fit_damped_sinusoid(render(9600), 48000);
  EXPECT_NEAR(old.frequency_hz, 440, 0.1);
  ASSERT_TRUE(session_.perform(protocol::FreeObject{{.name = "x"}}, 0));
  render(4800);
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"x", bank("b.glb")}, 0));
  ASSERT_TRUE(strike({.name = "x"}));
  EXPECT_NEAR(test::fit_damped_sinusoid(render(9600), 48000).frequency_hz, 660, 0.1);
}

TEST_F(SessionTest, AMaterialScaleRetunesWhatRingsByTheRootOfStiffnessOverDensity) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"x", bank("a.glb")}, 0));
  ASSERT_TRUE(strike({.name = "x"}));
  render(4800);
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "x"}, {1, 1, 4, 9}}, 0));
  render(64);
  EXPECT_NEAR(test::fit_damped_sinusoid(render(9600), 48000).frequency_hz, 440 * 1.5, 0.1);
}

TEST_F(SessionTest, AFreedNumberIsUsedAgainOnlyOnceItIsSilent) {
  const auto first = session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0);
  ASSERT_TRUE(strike({.name = "a"}));
  render(480);
  ASSERT_TRUE(session_.perform(protocol::FreeObject{{.name = "a"}}, 0));
  const auto second = session_.perform(protocol::LoadObject{"b", bank("b.glb")}, 0);
  EXPECT_NE(**first, **second);
  render(4800);
  const auto third = session_.perform(protocol::LoadObject{"c", bank("a.glb")}, 0);
  EXPECT_EQ(**first, **third);
}

TEST_F(SessionTest, WhatCannotBeIsRefusedAndChangesNothing) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  EXPECT_FALSE(session_.perform(protocol::LoadObject{"a", bank("missing.glb")}, 0));
  EXPECT_TRUE(strike({.name = "a"}));
  EXPECT_FALSE(strike({.name = "b"}));
  EXPECT_FALSE(session_.play(protocol::StrikeVertex{{.name = "a"}, 4, {0, 0, 1}, 0}, 0));
  EXPECT_FALSE(session_.perform(protocol::FreeObject{{.name = "b"}}, 0));
  EXPECT_FALSE(session_.perform(protocol::SceneClear{}, 0));
  const auto day_ahead = static_cast<protocol::Frame>(86400.0 * 48000);
  EXPECT_FALSE(session_.play(protocol::SetGain{{.name = "a"}, 1, 0}, day_ahead));
}

TEST_F(SessionTest, TwoObjectsOfOneFileShareItsMemory) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"one", bank("a.glb")}, 0));
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"two", bank("a.glb")}, 0));
  EXPECT_EQ(session_.rack().find({.name = "one"})->map, session_.rack().find({.name = "two"})->map);
}

TEST_F(SessionTest, AFullQueueIsAnErrorAndIsCounted) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  for (std::size_t i = 0; i < synth::kQueueCapacity; ++i) ASSERT_TRUE(strike({.name = "a"}));
  const auto refused = strike({.name = "a"});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("dropped"), std::string::npos);
  EXPECT_EQ(session_.dropped(), 1u);
}

}  // namespace
}  // namespace ringdown::server
