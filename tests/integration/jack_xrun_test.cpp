// A daemon that missed cycles of a real-time JACK server: its scene and its sound stay together, and the loss is
// counted.
#include "tests/integration/daemon_fixture.h"
#include "tests/integration/jack_fixture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

class JackXrun : public testing::Test {
 protected:
  void SetUp() override {
    if (!installed("jackd")) GTEST_SKIP() << "needs jackd2 (./run packages)";
    ASSERT_TRUE(server_.runs());
  }

  // How far the scene is ahead of the sound, as both are reported [s]. The smallest of some looks: a report may wait.
  static double lead_s(Daemon& daemon) {
    double least = 1e9;
    for (int look = 0; look < 10; ++look) {
      const auto scene = ask_for<protocol::NotifyScene>(daemon, {"/notify", {1, 100.f}});
      const auto status = JackTest::status(daemon);
      if (scene && status) least = std::min(least, std::abs(scene->time_s - (status->captured_s - kStart_s)));
    }
    return least;
  }

  static constexpr double kStart_s = 1;  // of a scene that is loaded at the start, after the first frame
  TemporaryFolder folder_;
  JackServer server_{48000, 256, JackServer::Mode::realtime};
};

TEST_F(JackXrun, SceneAndSoundStayTogetherAndWhatWasSkippedIsCounted) {
  Daemon daemon(
      {"--scene", RINGDOWN_SOURCE_DIR "/presets/scenes/dominoes.toml", "--capture", (folder_ / "live.wav").string()},
      server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(becomes_true([&] { return JackTest::status(daemon)->captured_s > 2; }));
  EXPECT_LT(lead_s(daemon), 0.05);
  const double skipped_s = JackTest::status(daemon)->skipped_s, slowed_s = JackTest::status(daemon)->slowed_s;
  for (int i = 1; i <= 3; ++i) {
    daemon.process().send_signal(SIGSTOP);
    std::this_thread::sleep_for(400ms);
    daemon.process().send_signal(SIGCONT);
    EXPECT_LT(lead_s(daemon), 0.05) << "after the interruption";
  }
  const auto status = JackTest::status(daemon);
  EXPECT_GT(status->skipped_s - skipped_s, 0.9);
  EXPECT_LT(status->slowed_s - slowed_s, 0.01) << "the scene waited for the sound, and lost nothing by itself";
  EXPECT_GT(status->xruns, 0);
}

// JACK's clock goes on while its server is held.
TEST_F(JackXrun, TheSceneWaitsForASoundThatDoesNotCome) {
  Daemon daemon(
      {"--scene", RINGDOWN_SOURCE_DIR "/presets/scenes/dominoes.toml", "--capture", (folder_ / "live.wav").string()},
      server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(becomes_true([&] { return JackTest::status(daemon)->captured_s > 2; }));
  server_.send_signal(SIGSTOP);
  std::this_thread::sleep_for(1s);
  const double lead = lead_s(daemon);
  server_.send_signal(SIGCONT);
  EXPECT_LT(lead, 0.05);
}

}  // namespace
}  // namespace ringdown::test
