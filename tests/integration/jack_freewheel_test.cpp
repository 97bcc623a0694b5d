// Live sound is what `ringdown render` computes: in freewheel, and whatever the period does.
#include "server/session/offline.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"

#include <cmath>
#include <iostream>

namespace ringdown::test {
namespace {

constexpr double kServerRate = 48000;

// The daemon's left output of the first seconds, and at which frame of it freewheel began.
struct Freewheel {
  Samples left;
  std::size_t from = 0;
};

Freewheel freewheel(const JackServer& server, const std::string& scene, std::size_t frames) {
  JackRecorder recorder(server.name(), "recorder", frames, JackRecorder::From::call);
  Daemon daemon({"--scene", scene, "--limiter", "off"}, server.environment());
  EXPECT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  EXPECT_TRUE(recorder.connect("ringdown:out_right", "recorder:in_2"));
  recorder.record();
  recorder.freewheel(true);
  EXPECT_TRUE(recorder.wait_for(frames));
  recorder.freewheel(false);
  return {recorder.samples(0), recorder.freewheels_from().value_or(frames)};
}

// Begun anew where the scene sounded before freewheel had begun: the scene then runs by the clock, on another thread.
TEST_F(JackTest, FreewheelRendersWhatRenderDoes) {
  constexpr int kMaxTries = 20;
  const std::string scene = std::string(RINGDOWN_SOURCE_DIR) + "/presets/scenes/demo.toml";
  const auto frames = static_cast<std::size_t>(12 * kServerRate);
  Freewheel heard_live;
  for (int tries = 0; tries < kMaxTries; ++tries) {
    heard_live = freewheel(server_, scene, frames);
    if (HasFailure() || silence_before(heard_live.left) > heard_live.from + 2400) break;
  }
  const Samples& live = heard_live.left;
  const std::size_t live_begin = silence_before(live);
  ASSERT_GT(live_begin, heard_live.from + 2400) << "freewheel never began before the scene sounded";

  const auto rendered = session::render_offline({.scene = scene, .seconds = 13, .sample_rate_hz = kServerRate},
                                                [](double) { return true; });
  ASSERT_TRUE(rendered);
  const Samples offline = to_doubles(rendered->left);
  KeepSignals keep(kServerRate);
  keep.add("live", live);
  keep.add("offline", offline);
  const std::size_t offline_begin = silence_before(offline);
  ASSERT_LT(live_begin, live.size());
  const auto heard = std::span(live).subspan(live_begin), wanted = std::span(offline).subspan(offline_begin);
  ASSERT_GT(std::min(heard.size(), wanted.size()), 8 * kServerRate);
  const double error_db = relative_error_db(heard, wanted);
  std::cout << "freewheel against offline: " << error_db << " dB over " << std::min(heard.size(), wanted.size())
            << " frames\n";
  EXPECT_LE(error_db, -120);
}

TEST_F(JackTest, EveryPeriodPlaysTheSameTone) {
  Daemon daemon({"--object", "tone=" + bank("slow.glb", kPitch_hz, 0.02).string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  for (const char* period : {"64", "1024", "32", "480"}) {
    ASSERT_EQ(run({"jack_bufsize", period}, server_.environment()).exit_code, 0);
    ASSERT_TRUE(becomes_true([&] { return status(daemon)->block_frames == std::stoi(period); }));
    daemon.send({"/clear", {}});
    daemon.send(strike("tone"));
    const auto frames = static_cast<std::size_t>(kServerRate);
    JackRecorder recorder(server_.name(), "recorder", frames);
    ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
    ASSERT_TRUE(recorder.wait_for(frames));
    const Samples heard = recorder.samples(0);
    KeepSignals keep(kServerRate);
    keep.add(std::string("period-") + period, heard);
    const auto tone = fit_damped_sinusoid(std::span(heard).last(8000), kServerRate);
    EXPECT_NEAR(tone.frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
    EXPECT_GT(tone.amplitude(), 0.01);
  }
}

}  // namespace
}  // namespace ringdown::test
