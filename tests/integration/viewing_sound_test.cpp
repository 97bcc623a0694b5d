// What somebody at a window hears and is told of the sound: modes by themselves, a choice of modes, the test tone; with
// a JACK client that records.
#include "engine/modal/bank_file.h"
#include "protocol/wire/message.h"
#include "tests/integration/jack_fixture.h"
#include "tests/integration/jack_recorder.h"
#include "tests/support/keep_signals.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/tone_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

constexpr double kRate = 48000, kSide = 0.5 * std::numbers::sqrt2;  // of a sound in the centre

struct Heard {
  Samples left, right;  // from the first frame on that is not silent
  DampedSinusoid tone;  // that fits the left side best
  double rest_db = 0;   // what is heard besides, against it
};

class ViewingSound : public JackTest {
 protected:
  // Modes that stand in no order, as those of a bank do.
  void SetUp() override {
    JackTest::SetUp();
    modal::Bank bank = single_mode_bank(1210, 3);
    bank.frequency_hz = {1210, 290, 2003, 707, 451};
    bank.decay_per_s = {3, 2, 5, 4, 6};
    bank.radiation->maps.modes.assign(5, even_field(1210));
    bank.shapes.assign(20, {0, 0, 1});
    ASSERT_TRUE(modal::write_bank(bank, folder_ / "bell.glb"));
  }
  [[nodiscard]] std::vector<std::string> with_bell() const {
    return {"--object", "bell=" + (folder_ / "bell.glb").string()};
  }

  // Half a second of what `play` makes a silent daemon sound like, but for so many frames at its begin.
  Heard hear(const std::function<void()>& play, std::size_t skipped = 0) {
    constexpr std::size_t kFrames = 24000, kBlock = 256;
    const std::size_t all = kBlock + skipped + kFrames;
    JackRecorder recorder(server_.name(), "recorder", all);
    EXPECT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
    EXPECT_TRUE(recorder.connect("ringdown:out_right", "recorder:in_2"));
    EXPECT_TRUE(recorder.wait_for_freewheel());
    play();
    if (!recorder.wait_for(all)) {
      ADD_FAILURE() << "silence";
      return {};
    }
    const Samples left = recorder.samples(0), right = recorder.samples(1);
    const std::size_t begin = silence_before(left) + skipped;
    Heard heard;
    heard.left.assign(left.begin() + static_cast<std::ptrdiff_t>(begin),
                      left.begin() + static_cast<std::ptrdiff_t>(begin + kFrames));
    heard.right.assign(right.begin() + static_cast<std::ptrdiff_t>(begin),
                       right.begin() + static_cast<std::ptrdiff_t>(begin + kFrames));
    heard.tone = fit_damped_sinusoid(heard.left, kRate);
    heard.rest_db = relative_error_db(heard.left, samples_of(heard.tone, kRate, kFrames));
    std::printf("%.4f Hz, decay %.4f/s, amplitude %.6f, the rest %.1f dB\n", heard.tone.frequency_hz,
                heard.tone.decay_per_s, heard.tone.amplitude(), heard.rest_db);
    KeepSignals keep(kRate);
    keep.add("heard", heard.left);
    return heard;
  }
};

TEST_F(ViewingSound, ARungModeIsHeardAloneAndAsLoudAsAsked) {
  Daemon daemon(with_bell(), server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const Heard heard = hear([&] { daemon.send({"/object/bell/ring", {1, 1, 0.25f}}); });
  EXPECT_NEAR(heard.tone.frequency_hz, 451, 1e-3);
  EXPECT_NEAR(heard.tone.decay_per_s, 6, 1e-3);
  EXPECT_NEAR(heard.tone.amplitude(), 0.25 * kSide, 1e-3 * 0.25);
  EXPECT_LT(heard.rest_db, -110);
  EXPECT_EQ(heard.left, heard.right);
}

TEST_F(ViewingSound, AStrikeRingsTheChosenModesAndNoOthers) {
  Daemon daemon(with_bell(), server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  ASSERT_TRUE(done(daemon, {"/object/bell/modes", {3, 1}}));
  Heard heard = hear([&] { daemon.send(strike("bell")); });
  EXPECT_NEAR(heard.tone.frequency_hz, 1210, 1e-3);
  EXPECT_NEAR(heard.tone.decay_per_s, 3, 1e-3);
  EXPECT_LT(heard.rest_db, -110);

  daemon.send({"/clear", {}});
  ASSERT_TRUE(becomes_true([&] { return status(daemon)->sounding_objects == 0; }));
  ASSERT_TRUE(done(daemon, {"/object/bell/modes", {0}}));
  heard = hear([&] { daemon.send(strike("bell")); });
  EXPECT_GT(heard.rest_db, -20) << "or the test above could not fail";
}

TEST_F(ViewingSound, TheTestToneIsASineOnBothSides) {
  Daemon daemon({}, server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  constexpr std::size_t kRamp = 960;
  const Heard heard = hear([&] { EXPECT_TRUE(done(daemon, {"/test_tone", {0.25f}})); }, kRamp);
  EXPECT_NEAR(heard.tone.frequency_hz, 440, 1e-4);
  EXPECT_NEAR(heard.tone.decay_per_s, 0, 1e-4);
  EXPECT_NEAR(heard.tone.amplitude(), 0.25, 1e-6);
  EXPECT_LT(heard.rest_db, -120);
  EXPECT_EQ(heard.left, heard.right);

  ASSERT_TRUE(done(daemon, {"/test_tone", {0.f}}));
  JackRecorder recorder(server_.name(), "after", 2 * kRamp, JackRecorder::From::call);
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "after:in_1"));
  ASSERT_TRUE(recorder.wait_for_freewheel());
  recorder.record();
  ASSERT_TRUE(recorder.wait_for(2 * kRamp));
  const Samples after = recorder.samples(0);
  EXPECT_EQ(peak(std::span(after).last(kRamp)), 0);
}

// Two sides of told sound by frame, NaN where none was told.
struct Told {
  std::optional<std::int32_t> first;
  Samples left, right;

  void add(const protocol::NotifySound& sound) {
    if (!first) first = sound.frame;
    const auto at = static_cast<std::size_t>(sound.frame - *first);
    const auto samples = wire::decode_floats(sound.samples);
    const std::size_t frames = samples.size() / 2;
    for (Samples* side : {&left, &right}) {
      side->resize(std::max(side->size(), at + frames), std::numeric_limits<double>::quiet_NaN());
    }
    for (std::size_t n = 0; n < frames; ++n) {
      left[at + n] = samples[2 * n];
      right[at + n] = samples[2 * n + 1];
    }
  }
};

TEST_F(ViewingSound, TheSoundThatIsToldIsWhatJackGetsSampleBySample) {
  Daemon daemon(with_bell(), server_.environment());
  ASSERT_TRUE(daemon.ready()) << daemon.process().output();
  const auto max = static_cast<std::size_t>(2 * kRate);
  JackRecorder recorder(server_.name(), "recorder", max, JackRecorder::From::call);
  ASSERT_TRUE(done(daemon, {"/notify", {1, 0.1f}}));
  daemon.send({"/watch/sound", {1}});
  daemon.send({"/object/bell/pan", {-0.5f}});
  daemon.send({"/object/bell/ring", {0, 5, 0.1f}});
  daemon.send({"/test_tone", {0.1f, 997.f}});
  Told told;
  const auto listen = [&] {
    for (const protocol::Reply& reply : daemon.packet(100ms)) {
      if (const auto* sound = reply.get_if<protocol::NotifySound>()) told.add(*sound);
    }
  };
  ASSERT_TRUE(becomes_true([&] { return listen(), !told.left.empty() && told.left.back() != 0; }));
  ASSERT_TRUE(recorder.connect("ringdown:out_right", "recorder:in_2"));
  ASSERT_TRUE(recorder.connect("ringdown:out_left", "recorder:in_1"));
  ASSERT_TRUE(becomes_true([&] { return listen(), recorder.hears(0) && recorder.hears(1); }));
  recorder.record();
  ASSERT_TRUE(becomes_true([&] { return listen(), recorder.recorded() == max; }));

  constexpr std::ptrdiff_t kEnd = 256;
  const Samples left = recorder.samples(0), right = recorder.samples(1);
  std::ptrdiff_t end = 0;  // of the recorded in what was told
  ASSERT_TRUE(becomes_true([&] {
    listen();
    const auto found = std::search(told.left.begin(), told.left.end(), left.end() - kEnd, left.end());
    end = found - told.left.begin() + kEnd;
    return found != told.left.end();
  }));
  const auto same = [&](const Samples& recorded, const Samples& heard) {
    const auto count = static_cast<std::ptrdiff_t>(max);
    return end >= count && std::equal(recorded.begin(), recorded.end(), heard.begin() + (end - count));
  };
  EXPECT_TRUE(same(left, told.left));
  EXPECT_TRUE(same(right, told.right));
  EXPECT_NE(left, right);
  EXPECT_GT(peak(left), 0.05);
}

}  // namespace
}  // namespace ringdown::test
