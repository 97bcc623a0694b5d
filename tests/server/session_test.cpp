// Objects by name and number, and what requests do to them.
#include "engine/modal/bank_file.h"
#include "protocol/bulk.h"
#include "server/session/session.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <unistd.h>

namespace ringdown::session {
namespace {

using protocol::ObjectRef;

class SessionTest : public testing::Test {
 protected:
  SessionTest() {
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(440, 2), folder_ / "a.glb"));
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(660, 2), folder_ / "b.glb"));
  }

  [[nodiscard]] std::string bank(const std::string& name) const { return (folder_ / name).string(); }

  test::Samples render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    session_.rack().mixer().render(left, right);
    session_.rack().collect();
    return test::to_doubles(left);
  }

  Result<void> strike(const ObjectRef& object) {
    const auto now = session_.rack().mixer().counters().frames.load();
    return session_.play(protocol::Strike{object, {{1, 0, 0}, {0, 0, 1}, 0}}, now);
  }

  test::TemporaryFolder folder_;
  Session session_{48000};
};

TEST_F(SessionTest, ObjectsAreFoundByNameAndByTheNumberThatLoadReturned) {
  const auto number = session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0);
  ASSERT_TRUE(number && *number);
  const auto by_name = session_.rack().find({.name = "a"});
  const auto by_number = session_.rack().find({.number = static_cast<std::uint32_t>(**number)});
  ASSERT_TRUE(by_name && by_number);
  EXPECT_EQ(*by_name, *by_number) << "one snapshot";
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

// Whether each of the objects "a" and "b" is heard, struck anew.
class MuteAndSolo : public SessionTest {
 protected:
  MuteAndSolo() {
    for (const char* name : {"a", "b"}) EXPECT_TRUE(session_.perform(protocol::LoadObject{name, bank("a.glb")}, 0));
  }
  void set(const protocol::WorkerRequest& request) { ASSERT_TRUE(session_.perform(request, 0)); }
  bool heard(const char* name) {
    EXPECT_TRUE(session_.play(protocol::ClearAll{}, 0));
    render(4800);
    EXPECT_TRUE(strike({.name = name}));
    const double loud = test::peak(render(4800));
    EXPECT_TRUE(loud == 0 || loud > 1e-3) << loud;
    return loud > 0;
  }
  std::string heard() {
    std::string names;
    for (const char* name : {"a", "b", "c"}) {
      if (session_.rack().find({.name = name}) && heard(name)) names += name;
    }
    return names;
  }
};

TEST_F(MuteAndSolo, MutedObjectsAreSilentAndSoloedOnesAloneAreHeard) {
  const ObjectRef a{.name = "a"}, b{.name = "b"};
  EXPECT_EQ(heard(), "ab");
  set(protocol::SetMute{a});
  EXPECT_EQ(heard(), "b");
  set(protocol::SetMute{a, false});
  EXPECT_EQ(heard(), "ab");
  set(protocol::SetSolo{b});
  EXPECT_EQ(heard(), "b");
  set(protocol::SetSolo{a});
  EXPECT_EQ(heard(), "ab") << "several may be soloed";
  set(protocol::SetMute{b});
  EXPECT_EQ(heard(), "a") << "mute wins";
  set(protocol::SetSolo{a, false});
  EXPECT_EQ(heard(), "") << "the one that is soloed is muted";
  set(protocol::SetSolo{b, false});
  EXPECT_EQ(heard(), "a");
}

TEST_F(MuteAndSolo, ObjectsThatComeAndGoKeepTheRule) {
  set(protocol::SetSolo{{.name = "a"}});
  set(protocol::LoadObject{"c", bank("b.glb")});
  EXPECT_EQ(heard(), "a") << "the new one is not soloed";
  set(protocol::LoadObject{"a", bank("b.glb")});
  EXPECT_EQ(heard(), "a") << "a new bank changes nothing";
  set(protocol::FreeObject{{.name = "a"}});
  EXPECT_EQ(heard(), "bc") << "the soloed one is gone";
  render(9600);
  set(protocol::LoadObject{"a", bank("a.glb")});
  EXPECT_EQ(heard(), "abc") << "and its name begins anew";
}

TEST_F(SessionTest, TwiceTheSizeIsAnOctaveDown) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"x", bank("a.glb")}, 0));
  ASSERT_TRUE(strike({.name = "x"}));
  render(4800);
  ASSERT_TRUE(session_.perform(protocol::SetMaterial{{.name = "x"}, {1, 1, 1, 1, 2}}, 0));
  render(64);
  EXPECT_NEAR(test::fit_damped_sinusoid(render(9600), 48000).frequency_hz, 220, 0.1);
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

TEST_F(SessionTest, ARequestThatCannotBeIsRefusedAndChangesNothing) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  EXPECT_FALSE(session_.perform(protocol::LoadObject{"a", bank("missing.glb")}, 0));
  EXPECT_TRUE(strike({.name = "a"}));
  EXPECT_FALSE(strike({.name = "b"}));
  EXPECT_FALSE(session_.play(protocol::StrikeVertex{{.name = "a"}, {4, {0, 0, 1}, 0}}, 0));
  EXPECT_FALSE(session_.perform(protocol::FreeObject{{.name = "b"}}, 0));
  EXPECT_FALSE(session_.perform(protocol::SceneClear{}, 0));
  const auto day_ahead = static_cast<synth::Frame>(86400.0 * 48000);
  EXPECT_FALSE(session_.play(protocol::SetGain{{.name = "a"}, {1, 0}}, day_ahead));
}

TEST_F(SessionTest, TwoObjectsOfOneFileShareItsMemory) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"one", bank("a.glb")}, 0));
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"two", bank("a.glb")}, 0));
  EXPECT_EQ((*session_.rack().find({.name = "one"}))->map, (*session_.rack().find({.name = "two"}))->map);
}

// 1600 is one message's limit; 1601 and a broken record are refused whole.
TEST_F(SessionTest, AThousandObjectsOfOneFileRingForThePriceOfTwo) {
  for (int i = 0; i < 1000; ++i) {
    const std::string name = "coin" + std::to_string(i);
    ASSERT_TRUE(session_.perform(protocol::LoadObject{name, bank("a.glb")}, 0));
    ASSERT_TRUE(strike({.name = name}));
  }
  render(1024);
  EXPECT_EQ(session_.rack().mixer().counters().ringing_voices, 1000u);
  EXPECT_EQ(session_.rack().mixer().counters().ringing_modes, 2u);
}

TEST_F(SessionTest, ABulkOfStrikesRingsAsTheSameStrikesDoOneByOne) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"b", bank("a.glb")}, 0));
  std::vector<protocol::BulkStrike> blows;
  for (std::size_t i = 0; i < 100; ++i) {
    blows.push_back({static_cast<std::uint32_t>(i % 2),
                     i % 3 ? std::nullopt : std::optional(1u),
                     {1, 0, 0},
                     {0, 0, 0.5},
                     0.0005,
                     static_cast<double>(i) / 1000});
  }
  ASSERT_TRUE(session_.play(protocol::StrikeMany{protocol::encode_strikes(blows)}, 0));
  const auto bulk = render(9600);
  EXPECT_EQ(session_.rack().mixer().counters().strikes, 100u);

  Session other{48000};
  for (const char* name : {"a", "b"}) ASSERT_TRUE(other.perform(protocol::LoadObject{name, bank("a.glb")}, 0));
  for (const protocol::BulkStrike& blow : blows) {
    const auto frame = static_cast<synth::Frame>(std::llround(blow.delay_s * 48000));
    const ObjectRef object{.name = blow.object == 0 ? "a" : "b"};
    const double contact_time_s = static_cast<float>(blow.contact_time_s);
    if (blow.vertex) {
      ASSERT_TRUE(other.play(protocol::StrikeVertex{object, {1, {0, 0, 0.5}, contact_time_s}}, frame));
    } else {
      ASSERT_TRUE(other.play(protocol::Strike{object, {{1, 0, 0}, {0, 0, 0.5}, contact_time_s}}, frame));
    }
  }
  std::vector<float> left(9600), right(9600);
  other.rack().mixer().render(left, right);
  EXPECT_EQ(bulk, test::to_doubles(left));
}

TEST_F(SessionTest, OneWrongRecordRefusesTheWholeBulkByItsNumber) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  const protocol::BulkStrike good{0, std::nullopt, {1, 0, 0}, {0, 0, 1}, 0, 0};
  const auto refusal = [&](auto spoil) {
    std::vector<protocol::BulkStrike> blows(3, good);
    spoil(blows[1]);
    const auto played = session_.play(protocol::StrikeMany{protocol::encode_strikes(blows)}, 0);
    return played ? "" : played.error().message;
  };
  const double nan = std::nan("");
  EXPECT_NE(refusal([](auto& b) { b.object = 7; }).find("record 2"), std::string::npos);
  EXPECT_NE(refusal([](auto& b) { b.vertex = 4; }).find("record 2: there is no sample point 4"), std::string::npos);
  EXPECT_NE(refusal([](auto& b) { b.vertex = 1u << 31; }).find("record 2 (vertex)"), std::string::npos);
  EXPECT_NE(refusal([&](auto& b) { b.point_m.y = nan; }).find("record 2 (y)"), std::string::npos);
  EXPECT_NE(refusal([&](auto& b) { b.impulse_ns.z = HUGE_VAL; }).find("record 2 (jz)"), std::string::npos);
  EXPECT_NE(refusal([&](auto& b) { b.contact_time_s = nan; }).find("record 2 (contact_time)"), std::string::npos);
  EXPECT_NE(refusal([](auto& b) {
              b.delay_s = std::nextafter(float(protocol::kMaxDelay_s), 100.f);
            }).find("record 2 (delay)"),
            std::string::npos);
  render(256);
  EXPECT_EQ(session_.rack().mixer().counters().strikes, 0u);
  EXPECT_EQ(refusal([](auto& b) { b.delay_s = protocol::kMaxDelay_s; }), "") << "at the limit";
}

TEST_F(SessionTest, AFloodIsMergedWithoutLosingImpulse) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  session_.merge_within(0.001);
  constexpr std::size_t kFlood = 2 * synth::kQueueCapacity;
  for (std::size_t i = 0; i < kFlood; ++i) ASSERT_TRUE(strike({.name = "a"}));
  EXPECT_TRUE(session_.holds_strikes());
  session_.flush();
  EXPECT_EQ(session_.dropped(), 0u);
  EXPECT_EQ(session_.merged(), kFlood - StrikeMerger::kMaxUnmerged - 1);
  const auto flood = render(4800);
  Session other{48000};
  ASSERT_TRUE(other.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  ASSERT_TRUE(other.play(protocol::Strike{{.name = "a"}, {{1, 0, 0}, {0, 0, kFlood}, 0}}, 0));
  std::vector<float> left(4800), right(4800);
  other.rack().mixer().render(left, right);
  EXPECT_LT(test::relative_error_db(flood, test::to_doubles(left)), -120);
}

TEST_F(SessionTest, FilesOutsideTheRootsAreRefused) {
  std::filesystem::create_directory(folder_ / "open");
  std::filesystem::copy_file(folder_ / "a.glb", folder_ / "open/a.glb");
  Session guarded(48000, *FileRoots::only({folder_ / "open"}));
  EXPECT_TRUE(guarded.perform(protocol::LoadObject{"in", (folder_ / "open/a.glb").string()}, 0));
  const auto refused = guarded.perform(protocol::LoadObject{"out", bank("a.glb")}, 0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("--root"), std::string::npos);
  const auto scene = guarded.perform(protocol::SceneLoad{"/etc/passwd"}, 0);
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("--root"), std::string::npos);
}

TEST_F(SessionTest, AListenerHearsAnObjectFromItsPlaceUntilTheyLeave) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  const auto level = [&] {
    EXPECT_TRUE(strike({.name = "a"}));
    const auto heard = test::peak(render(4800));
    EXPECT_TRUE(session_.play(protocol::ClearAll{}, 0));
    render(4800);
    return heard;
  };
  const double alone = level();
  ASSERT_TRUE(session_.play(protocol::SetPose{{.name = "a"}, {{{10, 0, 0}, {}}}}, 0));
  EXPECT_NEAR(level() / alone, 1, 1e-3) << "nobody listens";
  ASSERT_TRUE(session_.play(protocol::SetListener{{{{0, 0, 0}, {}}}}, 0));
  render(2400);
  EXPECT_NEAR(level() / alone, 0.1, 1e-3) << "ten metres in front";
  const std::array<protocol::BulkPose, 1> aside = {protocol::BulkPose{0, {{0, 5, 0}, {}}, 0}};
  ASSERT_TRUE(session_.play(protocol::PoseMany{protocol::encode_poses(aside)}, 0));
  render(9600);
  EXPECT_NEAR(level() / alone, 0.2 * std::sqrt(2.0), 1e-3) << "five metres to the left";
  ASSERT_TRUE(session_.play(protocol::ListenerOff{}, 0));
  render(2400);
  EXPECT_NEAR(level() / alone, 1, 1e-3);
}

TEST_F(SessionTest, APoseThatIsNotTurnedByAUnitQuaternionIsRefusedInOneSentence) {
  ASSERT_TRUE(session_.perform(protocol::LoadObject{"a", bank("a.glb")}, 0));
  const Pose unturned{{0, 0, 0}, Rotation::from_xyzw(0, 0, 0, 0)};
  const std::array<protocol::BulkPose, 2> two = {protocol::BulkPose{0, {}, 0}, protocol::BulkPose{0, unturned, 0}};
  const std::array<Result<void>, 4> refused = {session_.play(protocol::SetPose{{.name = "a"}, {unturned}}, 0),
                                               session_.play(protocol::SetListener{{unturned}}, 0),
                                               session_.play(protocol::PoseMany{protocol::encode_poses(two)}, 0),
                                               session_.play(protocol::SetPose{{.name = "none"}, {{}}}, 0)};
  const std::array<const char*, 4> words = {"length 1", "length 1", "record 2", "no object"};
  for (std::size_t i = 0; i < refused.size(); ++i) {
    ASSERT_FALSE(refused[i]);
    EXPECT_NE(refused[i].error().message.find(words[i]), std::string::npos) << refused[i].error().message;
  }
}

TEST_F(SessionTest, ObjectsAreLoadedUpToTheLimitAndNotOneMore) {
  for (std::size_t i = 0; i < synth::kMaxObjects; ++i) {
    ASSERT_TRUE(session_.perform(protocol::LoadObject{"o" + std::to_string(i), bank("a.glb")}, 0)) << i;
    if (i % 256 == 0) render(64);
  }
  const auto refused = session_.perform(protocol::LoadObject{"more", bank("a.glb")}, 0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("2048"), std::string::npos) << refused.error().message;
  EXPECT_TRUE(strike({.name = "o2047"}));
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
}  // namespace ringdown::session
