// Inputs that excite objects, by requests: a sample is a force that acts for one frame.
#include "engine/modal/bank_file.h"
#include "server/session/session.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <unistd.h>

namespace ringdown::session {
namespace {

constexpr double kForce_n = 4800;

class Excite : public testing::Test {
 protected:
  Excite() {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 20), folder_ / "a.glb"));
    load("a");
  }

  void load(const std::string& name) {
    ASSERT_TRUE(session_.perform(protocol::LoadObject{name, (folder_ / "a.glb").string()}, 0));
  }
  auto excite(const std::string& object, std::uint32_t input, double force_n, Vec3 point_m = {1, 0, 0}) {
    return session_.perform(protocol::Excite{{.name = object}, input, point_m, {0, 0, force_n}}, 0);
  }
  // The sound when input 2 has a sample of 1 in the first frame.
  test::Samples kick(std::size_t frames = 4800) {
    std::vector<float> left(frames), right(frames), input(frames);
    input[0] = 1;
    session_.rack().mixer().render(synth::Outputs(left.data(), right.data()), {nullptr, input.data()}, frames);
    return test::to_doubles(left);
  }
  test::Samples strike(double impulse_ns, std::size_t frames = 4800) {
    const auto now = session_.rack().mixer().counters().frames.load();
    EXPECT_TRUE(session_.play(protocol::Strike{{.name = "a"}, {{1, 0, 0}, {0, 0, impulse_ns}, 0}}, now));
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    return test::to_doubles(left);
  }
  void fall_silent() {
    std::vector<float> left(96000), right(96000);
    for (int i = 0; i < 8; ++i) session_.rack().mixer().render(left, right);
    ASSERT_EQ(session_.rack().mixer().counters().ringing_voices, 0u);
  }

  test::TemporaryFolder folder_;
  Session session_{48000};
};

TEST_F(Excite, ASampleOfAnInputIsThatForceForAFrame) {
  ASSERT_TRUE(excite("a", 2, kForce_n));
  const auto kicked = kick();
  fall_silent();
  const auto struck = strike(kForce_n / 48000);
  EXPECT_GT(test::peak(struck), 1e-4);
  EXPECT_LE(test::relative_error_db(kicked, struck), -100);
}

// The session, to which OSC speaks, refuses them for inputs and hands as it does for strikes, measured in the object's
// own size.
TEST_F(Excite, PointsFarFromTheObjectAreRefused) {
  const auto refusal = [](const auto& outcome) { return outcome ? std::string() : outcome.error().message; };
  const auto excite_at = [&](double x) {
    return refusal(session_.perform(protocol::Excite{{.name = "a"}, 2, {x, 0, 0}, {0, 0, 1}}, 0));
  };
  const auto hold_at = [&](double x, double damping) {
    return refusal(session_.perform(protocol::Hold{{.name = "a"}, {{x, 0, 0}, {}, damping}}, 0));
  };
  EXPECT_NE(excite_at(100).find("m off the object"), std::string::npos) << excite_at(100);
  EXPECT_NE(hold_at(100, 1).find("m off the object"), std::string::npos) << hold_at(100, 1);
  EXPECT_EQ(hold_at(100, 0), "") << "a hand is taken away from wherever it is said to be";
  EXPECT_EQ(excite_at(1), "");
  EXPECT_EQ(hold_at(1, 1), "");
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "a"}, {.size = 100}}, 0));
  EXPECT_EQ(excite_at(100), "");
  EXPECT_EQ(refusal(session_.play(protocol::Strike{{.name = "a"}, {{100, 0, 0}, {0, 0, 1}, 0}}, 0)), "");
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "a"}, {.size = 0.01}}, 0));
  EXPECT_NE(excite_at(1).find("m off the object"), std::string::npos) << "the object measures 2 cm now";
}

// The other way round, a pickup is an output that shows how a point moves, with a port of its own.
TEST_F(Excite, APickupIsCheckedAsAStrikeIsAndGetsAPort) {
  const auto pickup = [&](Vec3 point_m, Vec3 direction, std::uint32_t number) {
    const auto set = session_.play(protocol::SetPickup{{.name = "a"}, {point_m, direction, number}}, 0);
    return set ? std::string() : set.error().message;
  };
  EXPECT_TRUE(session_.rack().ports().empty());
  EXPECT_NE(pickup({100, 0, 0}, {0, 0, 1}, 3).find("m off the object"), std::string::npos);
  EXPECT_EQ(pickup({1, 0, 0}, {0, 0, 7}, 3), "");
  const std::map<std::size_t, std::string> wanted{{synth::kMaxBuses + 2, "pickup_3"}};
  EXPECT_EQ(session_.rack().ports(), wanted);
  strike(2);
  EXPECT_EQ(session_.rack().mixer().counters().refused, 0u);
  EXPECT_EQ(pickup({}, {}, 3), "");
  const auto changes = session_.rack().observers().version();
  session_.rack().collect();
  EXPECT_GT(session_.rack().observers().version(), changes) << "the driver is told of the port";
}

TEST_F(Excite, AnInputsForceIsTheSameAtAnotherRate) {
  ASSERT_TRUE(excite("a", 2, kForce_n));
  session_.change_sample_rate(96000);
  const auto kicked = kick();
  fall_silent();
  EXPECT_LE(test::relative_error_db(kicked, strike(kForce_n / 96000)), -100);
  ASSERT_TRUE(excite("a", 2, kForce_n)) << "and when it is said again there";
  fall_silent();
  const auto again = kick();
  EXPECT_LE(test::relative_error_db(again, kicked), -100);
}

TEST_F(Excite, ANewBankAndMaterialKeepTheInput) {
  ASSERT_TRUE(excite("a", 2, kForce_n));
  load("a");
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "a"}, {1, 1, 1, 4}}, 0));
  EXPECT_GT(test::peak(kick()), 1e-4);
}

TEST_F(Excite, NoForceAndNoObjectEndAnInput) {
  ASSERT_TRUE(excite("a", 2, kForce_n));
  ASSERT_TRUE(excite("a", 2, 0));
  EXPECT_EQ(test::peak(kick()), 0);
  EXPECT_FALSE(excite("a", 2, 0)) << "there is nothing to end";
  ASSERT_TRUE(excite("a", 2, kForce_n));
  ASSERT_TRUE(session_.perform(protocol::FreeObject{{.name = "a"}}, 0));
  kick();
  EXPECT_FALSE(session_.rack().excitations()[1]);
  fall_silent();
  session_.rack().collect();
  load("b");
  EXPECT_EQ(test::peak(kick()), 0) << "whoever gets the number next is left in peace";
}

TEST_F(Excite, AnInputExcitesOneObjectAndEachOfFourServes) {
  load("b");
  for (const char* object : {"a", "b"}) ASSERT_TRUE(excite(object, 2, kForce_n));
  for (std::uint32_t input = 1; input <= protocol::kMaxInputs; ++input) EXPECT_TRUE(excite("b", input, kForce_n));
  EXPECT_EQ(session_.rack().inputs(), 0b1111u);
  kick();
  EXPECT_EQ(session_.rack().mixer().counters().ringing_voices, 1u);
}

TEST_F(Excite, ABankOfMoreModesThanAnInputTakesIsRefused) {
  for (const std::size_t modes : {synth::kMaxDrivenColumns, synth::kMaxDrivenColumns + 1}) {
    const auto path = folder_ / "many.glb";
    const modal::Bank bank = test::random_bank(1, modes, 20);
    ASSERT_TRUE(modal::write_bank(bank, path));
    ASSERT_TRUE(session_.perform(protocol::LoadObject{"many", path.string()}, 0));
    const auto& [x, y, z] = bank.positions[0];
    const auto excited = excite("many", 1, kForce_n, {x, y, z});
    EXPECT_EQ(excited.has_value(), modes == synth::kMaxDrivenColumns);
    const std::string sentence = excited ? "4096" : excited.error().message;
    EXPECT_NE(sentence.find("4096"), std::string::npos) << sentence;
  }
}

}  // namespace
}  // namespace ringdown::session
