// ringdown-bullet as a program: what a daemon receives of it, what its scores sound like, and what it refuses.
#include "engine/modal/bank_file.h"
#include "protocol/wire/score.h"
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/sound_file.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace ringdown::test {
namespace {

// A ball that falls and bounces while a box slides past; both are at rest after a second, long before the program ends.
constexpr const char* kScene = R"(
[scene]
duration_s = 2.5
[[object]]
name = "ball"
bank = "ball.glb"
gain = 0.5
pan = -1
[[object]]
name = "box"
bank = "box.glb"
[[static]]
name = "floor"
shape = "plane"
restitution = 0.5
[[body]]
name = "ball"
object = "ball"
shape = "sphere"
radius_m = 0.05
density_kg_m3 = 1000
position_m = [0, 0, 0.35]
restitution = 0.5
[[body]]
name = "box"
object = "box"
size_m = [0.1, 0.1, 0.04]
density_kg_m3 = 2000
position_m = [1, 0, 0.0201]
velocity_m_s = [1.5, 0, 0]
restitution = 0
)";

class BulletClient : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(modal::write_bank(single_mode_bank(600, 4, {1, 1, 1}), folder_ / "ball.glb"));
    ASSERT_TRUE(modal::write_bank(single_mode_bank(900, 4, {1, 1, 1}), folder_ / "box.glb"));
    std::ofstream(scene_) << kScene << "[contact]\nrest_damping_s_m = 0\n";
  }

  [[nodiscard]] static std::vector<wire::ScoreEvent> of(const std::vector<wire::ScoreEvent>& score,
                                                        const std::string& address) {
    std::vector<wire::ScoreEvent> found;
    for (const wire::ScoreEvent& event : score) {
      if (event.message.address == address) found.push_back(event);
    }
    return found;
  }

  std::vector<wire::ScoreEvent> read(const std::filesystem::path& path) {
    const auto score = wire::read_score(path);
    EXPECT_TRUE(score) << score.error().message;
    return score.value_or(std::vector<wire::ScoreEvent>());
  }

  // What a daemon records that the client plays, ended when what was struck has died away: both bodies rest long
  // before.
  void record_client(const std::filesystem::path& score) {
    Daemon daemon({"--driver", "null", "--root", folder_.path().string(), "--record", score.string()});
    ASSERT_TRUE(daemon.ready()) << daemon.process().output();
    const Outcome outcome = run({program("ringdown-bullet"), scene_.string(), "--lead", "3", "--to",
                                 "osc.udp://127.0.0.1:" + std::to_string(daemon.port())});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    int max = 0;
    ASSERT_TRUE(becomes_true([&] {
      const auto status = ask_for<protocol::StatusReply>(daemon, {"/status", {}});
      max = std::max(max, status ? status->sounding_objects : 0);
      return max == 2 && status && status->sounding_objects == 0;
    }));
    daemon.send({"/quit", {}});
    ASSERT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  }

  void write_events(const std::filesystem::path& score) {
    const Outcome outcome = run({program("ringdown-bullet"), scene_.string(), "--events", score.string()});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
  }

  TemporaryFolder folder_;
  std::filesystem::path scene_ = folder_ / "scene.toml", score_ = folder_ / "bullet.osc";
};

TEST_F(BulletClient, ADaemonReceivesFromTheBulletClientWhatItsScoreSays) {
  const auto recorded = folder_ / "daemon.osc";
  ASSERT_NO_FATAL_FAILURE(record_client(recorded));
  write_events(score_);
  const auto sent = read(score_), received = read(recorded);
  for (const char* address : {"/object/ball/strike", "/object/box/contact"}) {
    const auto expected = of(sent, address), found = of(received, address);
    ASSERT_GT(expected.size(), 2u) << address;
    ASSERT_EQ(found.size(), expected.size()) << address;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].message, expected[k].message) << address << " " << k;
      EXPECT_NEAR(found[k].time_s - found[0].time_s, expected[k].time_s - expected[0].time_s, 0.005) << address << k;
    }
  }
  EXPECT_TRUE(of(received, "/object/box/hold").empty());
  EXPECT_FALSE(of(received, "/object/ball/gain").empty());
  EXPECT_FALSE(of(received, "/object/ball/pan").empty());
}

// The box stops, and lies on the floor with four corners.
TEST_F(BulletClient, ABodyThatRestsIsDampedInTheDaemonAtItsTime) {
  std::ofstream(scene_) << kScene;
  const auto recorded = folder_ / "daemon.osc";
  ASSERT_NO_FATAL_FAILURE(record_client(recorded));
  write_events(score_);
  const auto sent = read(score_), received = read(recorded);
  const auto expected = of(sent, "/object/box/hold"), found = of(received, "/object/box/hold");
  ASSERT_GE(expected.size(), 8u);
  ASSERT_EQ(found.size(), 4u) << "what is told again as it was changes nothing";
  const double sent_s = expected[0].time_s - of(sent, "/object/box/contact")[0].time_s;
  const double found_s = found[0].time_s - of(received, "/object/box/contact")[0].time_s;
  EXPECT_NEAR(found_s, sent_s, 0.005);
}

TEST_F(BulletClient, TheBulletClientsScoreSoundsAsTheSceneDoesInRender) {
  write_events(score_);
  const auto ours = folder_ / "ode.wav", theirs = folder_ / "bullet.wav";
  const std::vector<std::string> scene = {"--scene", scene_.string()}, events = {"--events", score_.string()};
  for (const auto& [what, to] : {std::pair(scene, ours), std::pair(events, theirs)}) {
    const Outcome rendered =
        run({program("ringdown"), "render", what[0], what[1], "--seconds", "0.6", "-o", to.string()});
    ASSERT_EQ(rendered.exit_code, 0) << rendered.output;
  }
  // The ball's first ring, from its onset on: a scene in the daemon begins a step late. The box is hardly heard beside.
  const auto ring = [](const std::filesystem::path& file) {
    const Samples left = read_left(file);
    const auto onset = std::find_if(left.begin(), left.end(), [](double s) { return std::abs(s) > 0.01; });
    return onset + 9600 < left.end() ? Samples(onset, onset + 9600) : Samples();
  };
  const Samples ode = ring(ours), bullet = ring(theirs);
  ASSERT_FALSE(ode.empty());
  ASSERT_FALSE(bullet.empty());
  EXPECT_LT(relative_error_db(bullet, ode), -30);
}

TEST_F(BulletClient, TheBulletClientWritesTheSameScoreTwice) {
  const auto bytes = [&] {
    write_events(score_);
    std::ifstream file(score_, std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  const std::string first = bytes();
  EXPECT_GT(first.size(), 1000u);
  EXPECT_EQ(first, bytes());
}

TEST_F(BulletClient, TheBulletClientRefusesInOneSentence) {
  const auto refuse = [&](std::vector<std::string> arguments, int code, const std::string& word) {
    arguments.insert(arguments.begin(), program("ringdown-bullet"));
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.output;
    EXPECT_NE(outcome.output.find(word), std::string::npos) << outcome.output;
  };
  std::ofstream(scene_, std::ios::app) << "[[joint]]\nname = \"string\"\ntype = \"ball\"\nbodies = [\"ball\"]\n"
                                          "anchor_m = [0, 0, 1]\n";
  refuse({scene_.string(), "--events", score_.string()}, 3, "joint 'string'");
  EXPECT_FALSE(std::filesystem::exists(score_));
  refuse({(folder_ / "missing.toml").string()}, 3, "missing.toml");
  refuse({scene_.string(), "--seconds", "soon"}, 2, "--seconds");
  std::ofstream(scene_) << kScene;
  refuse({scene_.string(), "--to", "http://here"}, 2, "osc.udp");
  const auto nobody = wire::OscSocket::bind();
  ASSERT_TRUE(nobody);
  refuse({scene_.string(), "--to", "osc.udp://127.0.0.1:" + std::to_string(nobody->port())}, 6, "no answer");
}

}  // namespace
}  // namespace ringdown::test
