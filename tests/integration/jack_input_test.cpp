// Audio inputs that excite objects: a sample is a force.
#include "engine/synth/modes/mode_table.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"
#include "tests/support/synthetic_bank.h"

#include <cmath>
#include <numbers>

namespace ringdown::test {
namespace {

constexpr double kForce_n = 24000;  // of a sample of 1

class JackInput : public JackTest {
 protected:
  // How loud the tone begins after one sample of 1 from another client.
  double loudness(int rate, const std::string& input) {
    const auto frames = static_cast<std::size_t>(rate);
    JackRecorder client(server_.name(), "studio", frames);
    EXPECT_TRUE(client.works());
    EXPECT_TRUE(becomes_true([&] { return client.connect("studio:audio_out", input); }));
    EXPECT_TRUE(client.connect("ringdown:out_left", "studio:in_1"));
    EXPECT_TRUE(client.wait_for_freewheel());
    client.kick(1);
    EXPECT_TRUE(client.wait_for(frames));
    const Samples heard = client.samples(0);
    KeepSignals keep(rate);
    keep.add("heard", heard);
    const std::size_t first = silence_before(heard);
    EXPECT_LT(first + frames / 5, heard.size()) << "nothing was heard";
    if (first + frames / 5 >= heard.size()) return 0;
    return fit_damped_sinusoid(std::span(heard).subspan(first - 1, frames / 5), rate).amplitude();
  }

  // What one mode of unit mass gives after an impulse, in the middle of the stereo mix.
  static double after_impulse(double impulse_ns) {
    return std::numbers::sqrt2 / 2 * ringdown::test::kLoudness * 2 * std::numbers::pi * kPitch_hz * impulse_ns;
  }
};

TEST_F(JackInput, ASampleOfAnInputIsAForceForOneFrameAtEveryRateAndServer) {
  const std::string tone = bank("short.glb", kPitch_hz, 60).string();  // silent before each blow
  Daemon daemon({"--object", "tone=" + tone, "--input", "tone:1,0,0:0,0," + std::to_string(kForce_n)},
                server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const double expected = after_impulse(kForce_n / 48000);
  EXPECT_GT(expected, 1e-3);
  EXPECT_NEAR(loudness(48000, "ringdown:in_1"), expected, 1e-3 * expected);

  server_.stop(SIGKILL);
  server_.start(96000, 512);
  ASSERT_TRUE(server_.runs());
  ASSERT_TRUE(becomes_true([&] { return server_.connections().contains("ringdown:in_1"); }));
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 0; }));
  EXPECT_NEAR(loudness(96000, "ringdown:in_1"), expected / 2, 1e-3 * expected) << "half as long a frame";
}

TEST_F(JackInput, AnInputComesBackWithItsConnection) {
  Daemon daemon({"--object", "tone=" + bank_.string(), "--input", "tone"}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto connected = [&] { return server_.connections()["ringdown:in_1"].contains("system:capture_2"); };
  ASSERT_TRUE(becomes_true([&] { return server_.connections().contains("ringdown:in_1"); }));
  ASSERT_EQ(run({"jack_connect", "system:capture_2", "ringdown:in_1"}, server_.environment()).exit_code, 0);
  ASSERT_TRUE(becomes_true(connected));
  ASSERT_TRUE(driver_looks(daemon));
  server_.stop(SIGKILL);
  server_.start(44100, 128);
  ASSERT_TRUE(server_.runs());
  EXPECT_TRUE(becomes_true(connected)) << daemon.process().output();
}

TEST_F(JackInput, AnInputIsMadeAndMovedByMessages) {
  Daemon daemon({"--object", "tone=" + bank("short.glb", kPitch_hz, 60).string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_FALSE(server_.connections().contains("ringdown:in_1")) << "none unless asked for";
  const auto excite = [&](double force_n) {
    return daemon.ask(protocol::format(protocol::Excite{{.name = "tone"}, 3, {1, 0, 0}, {0, 0, force_n}}));
  };
  ASSERT_TRUE(excite(kForce_n)->holds<protocol::Done>());
  EXPECT_GT(loudness(48000, "ringdown:in_3"), 1e-3);
  ASSERT_TRUE(excite(0)->holds<protocol::Done>());
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 0; }));
  JackRecorder client(server_.name(), "studio", 480000, JackRecorder::From::call);
  ASSERT_TRUE(client.connect("studio:audio_out", "ringdown:in_3"));
  ASSERT_TRUE(client.connect("ringdown:out_left", "studio:in_1"));
  ASSERT_TRUE(client.wait_for_freewheel());
  client.kick(1);
  client.record();
  ASSERT_TRUE(client.wait_for(480000));
  ASSERT_TRUE(client.kicked());
  EXPECT_EQ(peak(client.samples(0)), 0);
}

TEST_F(JackInput, WrongOptionsOfInputsAreRefused) {
  const auto refusal = [&](const std::vector<std::string>& inputs) {
    std::vector<std::string> command = {program("ringdownd"), "--port", "0", "--object", "tone=" + bank_.string()};
    for (const std::string& input : inputs) command.insert(command.end(), {"--input", input});
    return run(command, server_.environment());
  };
  EXPECT_EQ(refusal({"drum"}).exit_code, 3);
  EXPECT_NE(refusal({"drum"}).output.find("drum"), std::string::npos);
  EXPECT_EQ(refusal({"tone:1,2"}).exit_code, 2);
  EXPECT_EQ(refusal({"tone:1,2,3:1,2,nan"}).exit_code, 2);
  EXPECT_EQ(refusal({"tone", "tone", "tone", "tone", "tone"}).exit_code, 2);
}

}  // namespace
}  // namespace ringdown::test
