// Live sound is what `ringdown render` computes: in freewheel, and whatever the period does.
#include "server/session/offline.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"

#include <cmath>
#include <iostream>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

constexpr double kRate = 48000;

// Frames until the first that is not silent.
std::size_t silence_before(const Samples& samples) {
  std::size_t n = 0;
  while (n < samples.size() && samples[n] == 0) ++n;
  return n;
}

TEST_F(JackTest, FreewheelRendersWhatRenderDoes) {
  const std::string scene = std::string(RINGDOWN_SOURCE_DIR) + "/presets/scenes/demo.toml";
  const auto frames = static_cast<std::size_t>(12 * kRate);
  JackRecorder recorder(server_.name(), "recorder", frames);
  ASSERT_TRUE(recorder.works());
  Daemon daemon({"--scene", scene}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  ASSERT_TRUE(recorder.connect("ringdown:out_right", "recorder:in_2"));
  recorder.freewheel(true);
  ASSERT_TRUE(recorder.wait_for(frames));
  recorder.freewheel(false);

  const auto rendered =
      session::render_offline({.scene = scene, .seconds = 13, .sample_rate_hz = kRate}, [](double) { return true; });
  ASSERT_TRUE(rendered);
  const Samples live = recorder.samples(0), offline = to_doubles(rendered->left);
  KeepSignals keep(kRate);
  keep.add("live", live);
  keep.add("offline", offline);
  const std::size_t live_begin = silence_before(live), offline_begin = silence_before(offline);
  ASSERT_LT(live_begin, live.size());
  const auto heard = std::span(live).subspan(live_begin), wanted = std::span(offline).subspan(offline_begin);
  ASSERT_GT(std::min(heard.size(), wanted.size()), 8 * kRate);
  const double error_db = relative_error_db(heard, wanted);
  std::cout << "freewheel against offline: " << error_db << " dB over " << std::min(heard.size(), wanted.size())
            << " frames\n";
  EXPECT_LE(error_db, -120);
}

TEST_F(JackTest, EveryPeriodPlaysTheSameTone) {
  Daemon daemon({"--object", "tone=" + bank("slow.glb", kPitch_hz, 0.5).string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  for (const char* period : {"64", "1024", "32", "480"}) {
    ASSERT_EQ(run({"jack_bufsize", period}, server_.environment()).exit_code, 0);
    ASSERT_TRUE(becomes_true([&] { return status(daemon)->block_frames == std::stoi(period); }));
    daemon.send({"/clear", {}});
    daemon.send(strike("tone"));
    const auto frames = static_cast<std::size_t>(kRate);
    JackRecorder recorder(server_.name(), "recorder", frames);
    ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
    recorder.freewheel(true);  // loses no block, however busy the machine
    ASSERT_TRUE(recorder.wait_for(frames));
    recorder.freewheel(false);
    const Samples heard = recorder.samples(0);
    KeepSignals keep(kRate);
    keep.add(std::string("period-") + period, heard);
    const auto tone = fit_damped_sinusoid(std::span(heard).last(8000), kRate);
    EXPECT_NEAR(tone.frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
    EXPECT_GT(tone.amplitude(), 0.01);
  }
}

}  // namespace
}  // namespace ringdown::test
