// The objects' own levels: what no sample of theirs exceeds.
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <array>
#include <cmath>

namespace ringdown::synth::test {
namespace {

constexpr double kTone_hz = 700, kToneDecay_per_s = 12;

// Two objects of one mode that share states, and one that does not.
class OneMode : public testing::Test {
 protected:
  OneMode() {
    const Map map = map_of(single_mode_bank(kTone_hz, kToneDecay_per_s));
    const auto table = std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate);
    for (ObjectNumber object = 0; object < 2; ++object) {
      EXPECT_TRUE(player_.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
    }
    player_.install(2, map);
    player_.mixer.meters().watch_objects(true);
  }

  // Of the unpanned sine that an impulse of 1 N s makes, after so many frames.
  static double envelope(double frames) {
    return ringdown::test::kLoudness * 2 * std::numbers::pi * kTone_hz * std::exp(-kToneDecay_per_s * frames / kRate);
  }

  Player player_;
};

TEST_F(OneMode, ThePeakLevelOfOneModeIsTheSinesAmplitude) {
  for (ObjectNumber object = 0; object < 3; ++object) {
    player_.push(gain_at(0, object, 0.5));
    player_.push(strike_at(128 * 10, object, {0, 0, 1.0 + object}));
  }
  player_.render(128 * 20, 128);
  for (ObjectNumber object = 0; object < 3; ++object) {
    const double impulse = 1.0 + object;
    EXPECT_NEAR(player_.mixer.meters().take_peak_level(object), 0.5 * impulse * envelope(128), 1e-5)
        << "since the strike";
    EXPECT_NEAR(player_.mixer.meters().take_peak_level(object), 0.5 * impulse * envelope(128 * 10), 1e-5)
        << "as it is now";
  }
  player_.render(4096, 4096);
  for (ObjectNumber object = 0; object < 3; ++object) {
    EXPECT_NEAR(player_.mixer.meters().take_peak_level(object), 0.5 * (1.0 + object) * envelope(128 * 11), 1e-5)
        << "in a long block";
  }
}

TEST_F(OneMode, ThePeakLevelFallsToZeroWhenAnObjectIsClearedOrHasDiedAway) {
  for (ObjectNumber object = 0; object < 3; ++object) player_.push(strike_at(0, object, {0, 0, 1}));
  player_.render(1280, 128);
  player_.push(clear_at(1280, 0));
  player_.render(2560, 128);
  for (ObjectNumber object = 0; object < 3; ++object)
    EXPECT_GT(player_.mixer.meters().take_peak_level(object), 0.1) << object;
  EXPECT_EQ(player_.mixer.meters().take_peak_level(0), 0) << "its fade is over";
  EXPECT_GT(player_.mixer.meters().take_peak_level(1), 0.1);
  player_.render(96000);
  for (ObjectNumber object = 0; object < 3; ++object) static_cast<void>(player_.mixer.meters().take_peak_level(object));
  for (ObjectNumber object = 0; object < 3; ++object)
    EXPECT_EQ(player_.mixer.meters().take_peak_level(object), 0) << object;
}

TEST_F(OneMode, AnObjectHasNoPeakLevelWhileNobodyWatches) {
  player_.mixer.meters().watch_objects(false);
  player_.push(strike_at(0, 2, {0, 0, 1}));
  player_.render(1280);
  EXPECT_EQ(player_.mixer.meters().take_peak_level(2), 0);
}

// Banks that take moments, and banks that do not, each with its own bus.
class ManyModes : public testing::TestWithParam<std::size_t> {
 protected:
  static constexpr std::size_t kObjects = 3;

  static void fill(Mixer& mixer) {
    for (ObjectNumber object = 0; object < kObjects; ++object) {
      const Map map = map_of(random_bank(object, GetParam(), 20));
      EXPECT_TRUE(mixer.install(object, voice_of(map), Mixer::Install::replace));
      EXPECT_TRUE(mixer.assign(object, object));
      EXPECT_TRUE(mixer.push(Producer::control, gain_at(0, object, 0.5 + object)));
      EXPECT_TRUE(mixer.push(Producer::control, vertex_strike_at(40 * object, object, 1, {1, 2, 3})));
    }
  }

  std::array<double, kObjects> render(std::size_t frames) {
    std::vector<float> left(frames), right(frames);
    std::array<std::vector<float>, kObjects> buses{left, left, left};
    Outputs outputs(left.data(), right.data());
    for (std::size_t b = 0; b < kObjects; ++b) outputs.listen_to_bus(b, buses[b].data());
    mixer_.render(outputs, frames);
    std::array<double, kObjects> peaks{};
    for (std::size_t b = 0; b < kObjects; ++b) peaks[b] = peak(to_doubles(buses[b]));
    return peaks;
  }

  Mixer mixer_{kRate};
};
INSTANTIATE_TEST_SUITE_P(FewAndMany, ManyModes, testing::Values(5, 600));

TEST_P(ManyModes, ManyModesNeverExceedTheirLevel) {
  fill(mixer_);
  mixer_.meters().watch_objects(true);
  render(256);
  for (int chunk = 0; chunk < 400; ++chunk) {
    std::array<double, kObjects> levels{};
    for (ObjectNumber object = 0; object < kObjects; ++object) {
      static_cast<void>(mixer_.meters().take_peak_level(object));
      levels[object] = mixer_.meters().take_peak_level(object);  // as it is now
    }
    if (chunk == 200) {
      ASSERT_TRUE(mixer_.push(Producer::control, clear_at(0, 0)));
    }
    const auto peaks = render(128);
    for (std::size_t object = 0; object < kObjects; ++object) {
      ASSERT_LE(peaks[object], levels[object] * (1 + 1e-5) + 1e-6) << "object " << object << ", chunk " << chunk;
      if (chunk < 10) {
        ASSERT_GT(peaks[object], 0.02 * levels[object]) << "and it is not far above";
      }
    }
  }
}

TEST_P(ManyModes, ManyModesSoundTheSameToTheBitWhoeverWatches) {
  std::array<std::vector<float>, 2> left;
  for (const bool watched : {false, true}) {
    Mixer mixer(kRate);
    fill(mixer);
    mixer.meters().watch_objects(watched);
    std::vector<float> right(9600);
    left[watched].resize(9600);
    mixer.render(left[watched], right);
  }
  EXPECT_EQ(left[0], left[1]);
}

TEST(PeakLevel, PeakLevelsOfAllObjectsAreMeasuredInTurn) {
  Player player;
  const Map map = map_of(single_mode_bank(300, 1));
  for (ObjectNumber object = 0; object < kMaxObjects; ++object) {
    player.install(object, map);
    player.push(strike_at(0, object, {0, 0, 1e-3}));
  }
  player.mixer.meters().watch_objects(true);
  player.render(128 * kMaxObjects / 64 + 256, 128);  // more strikes than a chunk takes
  player.render(128 * kMaxObjects / 64, 128);
  for (ObjectNumber object = 0; object < kMaxObjects; ++object) {
    ASSERT_GT(player.mixer.meters().take_peak_level(object), 1e-6) << object;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
