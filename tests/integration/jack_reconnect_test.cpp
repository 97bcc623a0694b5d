// The JACK server goes and comes: the daemon stays, and so does what rings.
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"
#include "tests/support/tone_samples.h"
#include "tests/support/whole_recording.h"

#include <array>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace ringdown::test {
namespace {

struct Format {
  int rate, period, signal;
};
constexpr std::array<Format, 8> kLives = {{{44100, 128, SIGTERM},
                                           {96000, 512, SIGKILL},
                                           {48000, 64, SIGTERM},
                                           {22050, 1024, SIGKILL},
                                           {48000, 256, SIGKILL},
                                           {192000, 2048, SIGTERM},
                                           {44100, 256, SIGKILL},
                                           {48000, 128, SIGTERM}}};

class JackReconnect : public JackTest {
 protected:
  // Returns the damped sinusoid that the daemon's left output plays now.
  DampedSinusoid listen(int rate) {
    const auto tone = whole_recording([&] { return take(rate); });
    EXPECT_TRUE(tone) << "no whole recording of a pure tone at " << rate << " Hz";
    return tone.value_or(DampedSinusoid());
  }

  // Records a fifth of a second of the left output and fits its later half. Nothing where the server refuses, or the
  // recording has lost something or is no pure tone, as at a server that has just begun.
  std::optional<DampedSinusoid> take(int rate) {
    const auto frames = static_cast<std::size_t>(rate / 5);
    JackRecorder recorder(server_.name(), "listener", frames);
    if (!recorder.works() || !recorder.connect("ringdown:out_left", "listener:in_1") || !recorder.wait_for(frames)) {
      return std::nullopt;
    }
    const Samples all = recorder.samples(0);
    KeepSignals keep(rate);
    keep.add("listened-at-" + std::to_string(rate), all);
    const auto heard = std::span(all).subspan(frames / 2);
    const DampedSinusoid tone = fit_damped_sinusoid(heard, rate);
    const bool is_pure = relative_error_db(samples_of(tone, rate, heard.size()), heard) < -60;
    return is_pure ? std::optional(tone) : std::nullopt;
  }

  // Ends the server; returns when the daemon has noticed.
  testing::AssertionResult end_server(Daemon& daemon, int signal) {
    const std::size_t said = daemon.process().output().size();
    server_.stop(signal);
    if (becomes_true([&] { return daemon.process().output().find("server has stopped", said) != std::string::npos; })) {
      return testing::AssertionSuccess();
    }
    return testing::AssertionFailure() << "the daemon did not notice: " << daemon.process().output();
  }

  // A connection to a port that jack_lsp lists.
  [[nodiscard]] bool connected(const std::string& ours, const std::string& theirs) const {
    const auto all = server_.connections();
    const auto found = all.find(ours);
    return found != all.end() && found->second.contains(theirs);
  }
};

TEST_F(JackReconnect, TheDaemonMeetsEightServersAtOtherRatesAndPeriods) {
  const auto slow = bank("slow.glb", kPitch_hz, 0.001);
  Daemon daemon({"--object", "tone=" + slow.string(), "--connect"}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(becomes_true([&] { return connected("ringdown:out_right", "system:playback_2"); }));
  EXPECT_EQ(run({"jack_connect", "ringdown:out_left", "system:playback_2"}, server_.environment()).exit_code, 0);
  ASSERT_TRUE(driver_looks(daemon));
  daemon.send({"/object/tone/gain", {0.5f}});
  daemon.send(strike("tone"));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 1; }));
  const double loudness = listen(48000).amplitude();
  ASSERT_GT(loudness, 0.01);

  std::size_t survived = 0;
  for (const auto& [rate, period, signal] : kLives) {
    SCOPED_TRACE(rate);
    ASSERT_TRUE(end_server(daemon, signal));
    server_.start(rate, period);
    ASSERT_TRUE(server_.runs());
    ASSERT_TRUE(becomes_true([&] {
      return connected("ringdown:out_left", "system:playback_1") &&
             connected("ringdown:out_left", "system:playback_2") &&
             connected("ringdown:out_right", "system:playback_2");
    })) << daemon.process().output();
    EXPECT_TRUE(becomes_true([&, rate = rate, period = period] {
      const auto now = status(daemon);
      return now && now->sample_rate_hz == rate && now->block_frames == period && now->sounding_objects == 1;
    })) << "a server of "
        << rate << " Hz, " << period << " frames";
    const DampedSinusoid tone = listen(rate);
    EXPECT_NEAR(tone.frequency_hz, kPitch_hz, 1e-3 * kPitch_hz) << "retuned to the server's rate";
    EXPECT_LT(tone.amplitude(), 1.01 * loudness);
    EXPECT_GT(tone.amplitude(), 0.5 * loudness) << "what was struck once still rings";
    survived += !HasFailure();
  }
  EXPECT_EQ(survived, kLives.size());
  EXPECT_EQ(status(daemon)->objects, 1);
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
}

TEST_F(JackReconnect, AConnectionComesBackWhenTheOtherClientDoes) {
  Daemon daemon({"--object", "tone=" + bank_.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  {
    JackRecorder mixing_desk(server_.name(), "desk", 1);
    ASSERT_TRUE(mixing_desk.connect("ringdown:out_left", "desk:in_2"));
    ASSERT_TRUE(becomes_true([&] { return connected("ringdown:out_left", "desk:in_2"); }));
    ASSERT_TRUE(driver_looks(daemon));
    server_.stop(SIGKILL);
  }
  server_.start(48000, 256);
  ASSERT_TRUE(server_.runs());
  ASSERT_TRUE(becomes_true([&] { return server_.connections().contains("ringdown:out_left"); }));
  JackRecorder mixing_desk(server_.name(), "desk", 1);
  EXPECT_TRUE(becomes_true([&] { return connected("ringdown:out_left", "desk:in_2"); })) << daemon.process().output();
}

TEST_F(JackReconnect, WithoutAServerTimePassesAndMessagesAreServed) {
  Daemon daemon({"--object", "tone=" + bank_.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  server_.stop(SIGKILL);
  ASSERT_TRUE(becomes_true([&] { return daemon.process().output().find("server has stopped") != std::string::npos; }));
  EXPECT_TRUE(becomes_true([&] { return daemon.send(strike("tone")), status(daemon)->sounding_objects == 1; }));
  EXPECT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 0; })) << "it dies away in silence";
  EXPECT_TRUE(daemon.ask({"/object/tone/free", {}})->holds<protocol::Done>());
  daemon.process().send_signal(SIGTERM);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
}

TEST_F(JackReconnect, TheDaemonWaitsForAServerIfAsked) {
  server_.stop();
  Daemon daemon({"--wait", "--object", "tone=" + bank_.string(), "--connect"}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_EQ(status(daemon)->sample_rate_hz, 48000);
  server_.start(44100, 512);
  ASSERT_TRUE(server_.runs());
  EXPECT_TRUE(becomes_true([&] { return connected("ringdown:out_left", "system:playback_1"); }));
  EXPECT_EQ(status(daemon)->sample_rate_hz, 44100);
  EXPECT_EQ(status(daemon)->block_frames, 512);
}

TEST_F(JackReconnect, TheDaemonDoesNotStartWithoutAServer) {
  server_.stop();
  const Outcome outcome = run({program("ringdownd"), "--port", "0"}, server_.environment());
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_NE(outcome.output.find("--wait"), std::string::npos) << outcome.output;
}

// Tests must not use up the machine's eight places for JACK servers, though some kill theirs, and some crash.
TEST(JackServerOfATest, TenTestsThatKillTheirJackServersLeaveAPlaceForTheNext) {
  if (!installed("jackd")) GTEST_SKIP() << "needs jackd2 (./run packages)";
  for (int life = 0; life < 10; ++life) {
    const pid_t crashing = ::fork();
    if (crashing == 0) {
      JackServer server;
      const bool up = server.runs();
      server.stop(SIGKILL);
      ::_exit(up ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(crashing, &status, 0), crashing);
    ASSERT_EQ(status, 0) << "server " << life;
  }
  JackServer next;
  EXPECT_TRUE(next.runs());
}

}  // namespace
}  // namespace ringdown::test
