// Live sound is what `ringdown render` computes: in freewheel, and whatever the period does.
#include "server/session/offline.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"
#include "tests/support/tone_samples.h"
#include "tests/support/whole_recording.h"

#include <chrono>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <regex>

namespace ringdown::test {
namespace {

constexpr double kServerRate = 48000;

// The daemon's left output of the first seconds. Nothing where the scene sounded before freewheel had begun, for it
// then ran by the clock, on another thread.
std::optional<Samples> freewheel(const JackServer& server, const std::string& scene, std::size_t frames) {
  constexpr std::size_t kBefore = 2400;  // frames of silence in freewheel
  JackRecorder recorder(server.name(), "recorder", frames, JackRecorder::From::call);
  Daemon daemon({"--scene", scene, "--limiter", "off"}, server.environment());
  EXPECT_TRUE(daemon.ready()) << daemon.process().output();
  EXPECT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  EXPECT_TRUE(recorder.connect("ringdown:out_right", "recorder:in_2"));
  recorder.record();
  recorder.freewheel(true);
  EXPECT_TRUE(recorder.wait_for(frames));
  recorder.freewheel(false);
  const Samples left = recorder.samples(0);
  const bool in_time = silence_before(left) > recorder.freewheels_from().value_or(frames) + kBefore;
  return in_time ? std::optional(left) : std::nullopt;
}

// The demo scene with a gain that its file may not change: modes rest at a level below full scale, so how far two
// renders of a scene agree, relative to its sound, depends on how loud it is.
std::string demo_scene(const std::filesystem::path& folder) {
  const std::string presets = std::string(RINGDOWN_SOURCE_DIR) + "/presets";
  std::ifstream file(presets + "/scenes/demo.toml");
  std::string text(std::istreambuf_iterator<char>(file), {});
  text = std::regex_replace(text, std::regex("\ngain = [0-9.]+"), "\ngain = 0.16",
                            std::regex_constants::format_first_only);
  text = std::regex_replace(text, std::regex("\"\\.\\./banks"), "\"" + presets + "/banks");
  const std::filesystem::path scene = folder / "demo.toml";
  std::ofstream(scene) << text;
  return scene.string();
}

TEST_F(JackTest, FreewheelRendersWhatRenderDoes) {
  const std::string scene = demo_scene(folder_.path());
  const auto frames = static_cast<std::size_t>(12 * kServerRate);
  const auto recording = whole_recording([&] { return freewheel(server_, scene, frames); });
  ASSERT_TRUE(recording) << "freewheel never began before the scene sounded";
  const Samples& live = *recording;
  const std::size_t live_begin = silence_before(live);

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
  constexpr std::chrono::seconds kTake{20};  // for a second of sound
  Daemon daemon({"--object", "tone=" + bank("slow.glb", kPitch_hz, 0.02).string()}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  for (const char* period : {"64", "1024", "32", "480"}) {
    ASSERT_EQ(run({"jack_bufsize", period}, server_.environment()).exit_code, 0);
    ASSERT_TRUE(becomes_true([&] { return status(daemon)->block_frames == std::stoi(period); }));
    const auto tone = whole_recording([&]() -> std::optional<DampedSinusoid> {
      daemon.send({"/clear", {}});
      daemon.send(strike("tone"));
      const auto frames = static_cast<std::size_t>(kServerRate);
      JackRecorder recorder(server_.name(), "recorder", frames);
      EXPECT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
      if (!recorder.wait_for(frames, kTake)) {
        std::cout << "a take of " << recorder.samples(0).size() << " frames; " << daemon.process().output();
        return std::nullopt;
      }
      const Samples heard = recorder.samples(0);
      KeepSignals keep(kServerRate);
      keep.add(std::string("period-") + period, heard);
      const auto end = std::span(heard).last(8000);
      const DampedSinusoid fitted = fit_damped_sinusoid(end, kServerRate);
      const bool is_pure = relative_error_db(samples_of(fitted, kServerRate, end.size()), end) < -60;
      return is_pure ? std::optional(fitted) : std::nullopt;
    });
    ASSERT_TRUE(tone) << "no pure tone with a period of " << period;
    EXPECT_NEAR(tone->frequency_hz, kPitch_hz, 1e-3 * kPitch_hz);
    EXPECT_GT(tone->amplitude(), 0.01);
  }
}

}  // namespace
}  // namespace ringdown::test
