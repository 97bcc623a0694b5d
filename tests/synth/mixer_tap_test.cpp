// What is put to the mix after the objects, and what is taken from it: the test tone, and the sound for those who
// watch.
#include "tests/synth/player.h"

namespace ringdown::synth::test {
namespace {

TEST(Tone, TheTestToneIsASineOfItsPeakOnBothSidesAndEndsInSilence) {
  Player player;
  player.mixer.test_tone().set(0.5, 440);
  player.render(24000);
  EXPECT_EQ(player.left, player.right);
  const DampedSinusoid heard = fit_damped_sinusoid(player.left_from(4800), kRate);
  EXPECT_NEAR(heard.frequency_hz, 440, 1e-3);
  EXPECT_NEAR(heard.decay_per_s, 0, 1e-3);
  EXPECT_NEAR(heard.amplitude(), 0.5, 1e-5);
  EXPECT_NEAR(player.mixer.counters().peak, 0.5, 1e-3);
  player.mixer.test_tone().set(0, 440);
  player.render(24000);
  EXPECT_EQ(peak(player.left_from(24000 + 480 + 1)), 0) << "10 ms later at most";
}

// A sine's own largest step is 2 pi f a / rate; a ramp adds a / (0.01 s rate) at most.
TEST(Tone, TheTestToneComesChangesAndGoesWithoutAClick) {
  Player player;
  const auto after = [&](double amplitude, double frequency_hz) {
    player.mixer.test_tone().set(amplitude, frequency_hz);
    player.render(4801, 77);
  };
  after(1, 1000);
  after(1, 300);
  after(0.2, 1000);
  after(0, 1000);
  const double max = 2 * std::numbers::pi * 1000 / kRate + 1 / (TestTone::kRamp_s * kRate);
  EXPECT_LE(largest_step(player.left, 1, player.left.size()), max);
  EXPECT_LE(std::abs(player.left[0]), max);
}

TEST(Tone, TheTestToneIsSilentFromHalfTheSampleRateUp) {
  Player player;
  player.mixer.test_tone().set(1, 24000);
  player.render(4800);
  EXPECT_EQ(peak(player.left), 0);
}

TEST(Tone, TheTestToneIsAddedToWhatRingsAndStaysOutOfBusesAndBelowTheCeiling) {
  Player alone, both;
  for (Player* player : {&alone, &both}) {
    player->install(0, map_of(single_mode_bank(700, 5)));
    player->push(strike_at(0, 0, {0, 0, 0.5}));
  }
  both.mixer.test_tone().set(0.25, 440);
  alone.render(9600), both.render(9600);
  Samples tone(9600);
  for (std::size_t n = 0; n < tone.size(); ++n) tone[n] = both.left[n] - alone.left[n];
  EXPECT_NEAR(fit_damped_sinusoid(std::span(tone).subspan(480), kRate).amplitude(), 0.25, 1e-5);

  ASSERT_TRUE(both.mixer.assign(0, 0));
  std::vector<float> bus(256);
  Outputs outputs;
  outputs.listen_to_bus(0, bus.data());
  both.mixer.render(outputs, 256);
  const DampedSinusoid heard = fit_damped_sinusoid(to_doubles(bus), kRate);
  EXPECT_NEAR(heard.frequency_hz, 700, 1);

  Player limited;
  set(limited.mixer, &MixerSettings::limiter_db, -6.0);
  limited.mixer.test_tone().set(1, 440);
  limited.render(9600);
  EXPECT_LE(peak(limited.left), 0.502);
  EXPECT_GE(peak(limited.left), 0.49);
}

TEST(Tone, ThePeakIsThatOfTheMixWithTheTestTone) {
  Player alone, both;
  for (Player* player : {&alone, &both}) {
    player->install(0, map_of(single_mode_bank(700, 5)));
    player->push(strike_at(0, 0, {0, 0, 0.5}));
  }
  both.mixer.test_tone().set(0.25, 440);
  constexpr std::size_t kBlock = 16;
  int quieter = 0;
  for (std::size_t begin = 0; begin < 4800; begin += kBlock) {
    alone.render(kBlock), both.render(kBlock);
    const double heard = std::max(peak(both.left_from(begin)), peak(std::span(both.right).subspan(begin)));
    EXPECT_EQ(both.mixer.counters().peak, static_cast<float>(heard)) << begin;
    if (heard < alone.mixer.counters().peak) ++quieter;
  }
  EXPECT_GT(quieter, 20) << "or it shows nothing";
}

struct Heard {
  Samples left, right;
  std::vector<Frame> begins;
};

Heard take_all(SoundTap& tap) {
  Heard heard;
  for (; const SoundTap::Piece* piece = tap.front(); tap.pop()) {
    heard.begins.push_back(piece->frame);
    EXPECT_EQ(piece->sample_rate_hz, kRate);
    for (std::size_t n = 0; n < piece->frames; ++n) {
      heard.left.push_back(piece->samples[2 * n]);
      heard.right.push_back(piece->samples[2 * n + 1]);
    }
  }
  return heard;
}

TEST(Tap, TheTapGivesTheMixAsItIsHeardWhileItIsWatched) {
  for (const std::size_t block : {64, 256, 1000}) {
    Player player;
    set(player.mixer, &MixerSettings::limiter_db, -3.0);
    player.mixer.test_tone().set(0.2, 440);
    player.install(0, map_of(single_mode_bank(700, 5)));
    player.push(pan_at(0, 0, -0.5));
    player.push(strike_at(100, 0, {0, 0, 5}));
    player.render(1000, block);
    EXPECT_FALSE(player.mixer.sound_tap().front()) << "nobody watches";
    player.mixer.sound_tap().watch(true);
    player.render(10000, block);
    const Heard heard = take_all(player.mixer.sound_tap());
    EXPECT_EQ(heard.begins.front(), 1000);
    EXPECT_EQ(heard.left, Samples(player.left.begin() + 1000, player.left.end()));
    EXPECT_EQ(heard.right, Samples(player.right.begin() + 1000, player.right.end()));
    player.mixer.sound_tap().watch(false);
    player.render(1000, block);
    EXPECT_FALSE(player.mixer.sound_tap().front());
  }
}

TEST(Tap, TheTapHearsAMixThatNobodyListensTo) {
  Player listened, unheard;
  unheard.mixer.sound_tap().watch(true);
  for (Player* player : {&listened, &unheard}) {
    player->install(0, map_of(single_mode_bank(700, 5)));
    player->push(strike_at(0, 0, {0, 0, 1}));
  }
  listened.render(2560);
  std::vector<float> left(256);
  Samples kept;
  for (int i = 0; i < 10; ++i) {
    Outputs outputs;
    if (i % 2 == 0) outputs.listen_to_mix(0, left.data());
    unheard.mixer.render(outputs, 256);
    if (i == 4) kept = to_doubles(left);
  }
  const Heard heard = take_all(unheard.mixer.sound_tap());
  EXPECT_EQ(heard.left, listened.left);
  EXPECT_EQ(heard.right, listened.right);
  EXPECT_EQ(kept, Samples(listened.left.begin() + 4 * 256, listened.left.begin() + 5 * 256));
}

TEST(Tap, ABlockWithoutOutputsIsTappedUpToTheLimitOfFrames) {
  Player player;
  player.mixer.sound_tap().watch(true);
  player.mixer.render(Outputs(), kMaxSpare);
  EXPECT_EQ(take_all(player.mixer.sound_tap()).left.size(), kMaxSpare);
  player.mixer.render(Outputs(), kMaxSpare + 1);
  EXPECT_TRUE(take_all(player.mixer.sound_tap()).left.empty());
  player.mixer.render(Outputs(), 64);
  EXPECT_EQ(take_all(player.mixer.sound_tap()).begins, std::vector<Frame>{2 * kMaxSpare + 1});
}

TEST(Tap, SoundThatFindsTheTapFullIsMissingAndTheFramesSaySo) {
  Player player;
  player.mixer.sound_tap().watch(true);
  player.render(256 * (kMaxTapped + 1), 256);
  EXPECT_EQ(take_all(player.mixer.sound_tap()).begins.size(), kMaxTapped);
  player.render(256, 256);
  EXPECT_EQ(take_all(player.mixer.sound_tap()).begins, std::vector<Frame>{256 * (kMaxTapped + 1)});
}

}  // namespace
}  // namespace ringdown::synth::test
