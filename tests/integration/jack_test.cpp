// The whole way with real parts: jackd, ringdownd, oscsend, and a JACK client that records. How exactly times are kept
// under real-time scheduling is measured by `./run bench deadline`.
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>

namespace ringdown::test {
namespace {

constexpr double kRate = 48000;

TEST_F(JackTest, AStrikeFromOscsendIsRecordedAtItsPitchAndDecay) {
  Daemon daemon({"--object", "tone=" + bank_.string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  JackRecorder recorder(server_.name(), "recorder", 48000);
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  ASSERT_TRUE(recorder.wait_for_freewheel());
  const auto sent = run({"oscsend", "osc.udp://127.0.0.1:" + std::to_string(daemon.port()), "/object/tone/strike",
                         "fffffff", "1", "0", "0", "0", "0", "0.5", "0"});
  EXPECT_EQ(sent.exit_code, 0) << sent.output;
  ASSERT_TRUE(recorder.wait_for(48000));
  const Samples heard = recorder.samples(0);
  KeepSignals keep(kRate);
  keep.add("heard", heard);

  const std::size_t begin = silence_before(heard);
  ASSERT_LT(begin, 256u) << "silence before the strike";
  const auto tone = fit_damped_sinusoid(std::span(heard).subspan(begin, 24000), kRate);
  EXPECT_NEAR(tone.frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
  EXPECT_NEAR(tone.decay_per_s, kDecay_per_s, 1e-2 * kDecay_per_s);
  EXPECT_GT(tone.amplitude(), 0.01);
}

TEST_F(JackTest, TheDaemonsPortsAreNamedAndGoneAfterASignal) {
  Daemon daemon({}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const Outcome ports = run({"jack_lsp"}, server_.environment());
  EXPECT_NE(ports.output.find("ringdown:out_left"), std::string::npos) << ports.output;
  EXPECT_NE(ports.output.find("ringdown:out_right"), std::string::npos) << ports.output;
  daemon.process().send_signal(SIGINT);
  EXPECT_EQ(daemon.process().wait(), 0) << daemon.process().output();
  EXPECT_EQ(run({"jack_lsp"}, server_.environment()).output.find("ringdown:"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::test
