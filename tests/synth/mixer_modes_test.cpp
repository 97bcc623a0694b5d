// Modes by themselves: set going without a strike, left out of an object, and watched while they ring.
#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <algorithm>

namespace ringdown::synth::test {
namespace {

// In order of importance, which is not that of pitch.
const std::vector<double> kPitches_hz = {1500, 400, 3100, 900}, kDecays_per_s = {5, 2, 9, 3};
const std::vector<std::size_t> kByPitch = {1, 3, 0, 2};
constexpr double kCentre = std::numbers::sqrt2 / 2;

Map four_modes() {
  modal::Bank bank = random_bank(3, 4, 12);
  bank.frequency_hz = kPitches_hz;
  bank.decay_per_s = kDecays_per_s;
  return map_of(bank);
}

Event ring_at(Frame frame, ObjectNumber object, std::uint32_t first, std::uint32_t count, double amplitude) {
  return {.frame = frame, .object = object, .verb = verb::Ring{first, count, amplitude}};
}

// a exp(-d t) sin(2 pi f t) of the modes of these ranks, from the first sample on.
Samples sines(std::size_t first, std::size_t end, double amplitude, std::size_t count) {
  Samples sum(count);
  for (std::size_t rank = first; rank < end; ++rank) {
    const double f = kPitches_hz[kByPitch[rank]], d = kDecays_per_s[kByPitch[rank]];
    for (std::size_t n = 0; n < count; ++n) {
      const double t = static_cast<double>(n) / kRate;
      sum[n] += amplitude * std::exp(-d * t) * std::sin(2 * std::numbers::pi * f * t);
    }
  }
  return sum;
}

std::unique_ptr<Voice> voice_with(const Map& map, modal::ModeRange modes, const modal::MaterialScale& material = {}) {
  return std::make_unique<Voice>(std::make_shared<ModeTable>(map, material, kRate, modal::Dampers{}, modes));
}

TEST(RingModes, OneModeSoundsAtItsPitchDecayAndTheAmplitudeThatWasAskedFor) {
  for (std::uint32_t rank = 0; rank < 4; ++rank) {
    Player player;
    player.install(0, four_modes());
    player.push(ring_at(1000, 0, rank, 1, 0.25));
    player.render(1000 + 24000);
    EXPECT_EQ(peak(std::span(player.left).first(1001)), 0);
    const DampedSinusoid heard = fit_damped_sinusoid(player.left_from(1000), kRate);
    EXPECT_NEAR(heard.frequency_hz, kPitches_hz[kByPitch[rank]], 1e-3);
    EXPECT_NEAR(heard.decay_per_s, kDecays_per_s[kByPitch[rank]], 1e-3);
    EXPECT_NEAR(heard.amplitude(), 0.25 * kCentre, 1e-5);
    EXPECT_EQ(player.mixer.counters().strikes, 1u);
  }
}

TEST(RingModes, AllModesTogetherAreTheSumOfTheirSines) {
  for (const std::size_t block : {16, 256, 1000}) {
    Player player;
    player.install(0, four_modes());
    player.push(ring_at(0, 0, 0, modal::ModeRange::kAll, 0.1));
    player.render(24000, block);
    EXPECT_LE(relative_error_db(player.left, sines(0, 4, 0.1 * kCentre, 24000)), -100) << block;
  }
}

TEST(RingModes, ARangeOfModesEndsWithTheBank) {
  Player player;
  player.install(0, four_modes());
  player.push(ring_at(0, 0, 2, 1000, 0.1));
  player.push(ring_at(0, 0, 4, 1, 0.1));
  player.render(12000);
  EXPECT_LE(relative_error_db(player.left, sines(2, 4, 0.1 * kCentre, 12000)), -100);
}

TEST(RingModes, ModesThatAreNotThereAreCountedAsRefused) {
  Player player;
  player.push(ring_at(0, 7, 0, 1, 0.1));
  player.render(256);
  EXPECT_EQ(player.mixer.counters().refused, 1u);
  EXPECT_EQ(player.mixer.counters().strikes, 0u);
}

// Three objects share their states, one of them moves its gain later and rings alone from then on.
TEST(RingModes, ObjectsThatShareStatesRingAsEachAlone) {
  Player player;
  const Map map = four_modes();
  const auto table = std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate);
  for (ObjectNumber object = 0; object < 3; ++object) {
    ASSERT_TRUE(player.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
  }
  player.push(gain_at(0, 1, 0.5));
  const std::size_t begin = 4800, part = 4800;
  player.push(ring_at(begin, 0, 0, 1, 0.1));
  player.push(ring_at(begin, 1, 1, 2, 0.1));
  player.push(gain_at(begin + part, 1, 0));
  player.render(begin + 24000);
  const Samples first = sines(0, 1, 0.1 * kCentre, 24000), second = sines(1, 3, 0.05 * kCentre, 24000);
  Samples both = first;
  for (std::size_t n = 0; n < both.size(); ++n) both[n] += second[n];
  EXPECT_LE(relative_error_db(player.left_from(begin).first(part), std::span(both).first(part)), -100);
  const std::size_t gone = part + 480;
  EXPECT_LE(relative_error_db(player.left_from(begin + gone), std::span(first).subspan(gone)), -90);
}

// One blow on two halves of an object and on the whole.
TEST(ModeChoice, TheModesOfTwoChoicesTogetherAreTheWholeObject) {
  const Map map = map_of(random_bank(5, 40, 30));
  Player halves, whole;
  ASSERT_TRUE(halves.mixer.install(0, voice_with(map, {0, 13}), Mixer::Install::replace));
  ASSERT_TRUE(halves.mixer.install(1, voice_with(map, {13}), Mixer::Install::replace));
  whole.install(0, map);
  for (const ObjectNumber half : {0u, 1u}) halves.push(strike_at(100, half, {0.01, 0.02, 0.03}));
  whole.push(strike_at(100, 0, {0.01, 0.02, 0.03}));
  halves.render(12000), whole.render(12000);
  EXPECT_LE(relative_error_db(halves.left, whole.left), -100);
}

TEST(ModeChoice, OnlyTheModesThatWereChosenSound) {
  Player player;
  ASSERT_TRUE(player.mixer.install(0, voice_with(four_modes(), {1, 1}), Mixer::Install::replace));
  player.push(strike_at(0, 0, {0.1, 0.2, 0.3}));
  player.render(24000);
  EXPECT_NEAR(fit_damped_sinusoid(player.left, kRate).frequency_hz, 900, 1e-3);
  player.push(ring_at(24000, 0, 0, modal::ModeRange::kAll, 0.1));
  player.render(24000);
  const DampedSinusoid heard = fit_damped_sinusoid(player.left_from(24000), kRate);
  EXPECT_NEAR(heard.frequency_hz, 900, 1) << "nor does another when it is rung";
}

TEST(ModeChoice, AChangeOfModesKeepsWhatStaysInPhaseAndLetsTheRestGoWithoutAClick) {
  Player player;
  const Map map = four_modes();
  player.install(0, map);
  player.push(ring_at(0, 0, 0, modal::ModeRange::kAll, 0.1));
  player.render(4800);
  ASSERT_TRUE(player.mixer.install(0, voice_with(map, {1, 2}), Mixer::Install::retune));
  player.render(19200);
  const Samples before = sines(0, 4, 0.1 * kCentre, 4800), after = sines(1, 3, 0.1 * kCentre, 24000);
  EXPECT_LE(relative_error_db(std::span(player.left).first(4800), before), -100);
  const std::size_t gone = 4800 + FadeOut::kMinFrames;
  EXPECT_LE(relative_error_db(player.left_from(gone), std::span(after).subspan(gone)), -100);
  EXPECT_LE(largest_step(player.left, 4790, gone), 1.01 * largest_step(before, 1, 4800));
}

TEST(ModeChoice, AModeChoiceSurvivesAnotherSampleRate) {
  Player player;
  ASSERT_TRUE(player.mixer.install(0, voice_with(four_modes(), {2, 1}), Mixer::Install::replace));
  player.render(256);
  player.mixer.change_sample_rate(44100);
  player.push(strike_at(256, 0, {0.1, 0.2, 0.3}));
  player.render(24000);
  EXPECT_NEAR(fit_damped_sinusoid(player.left_from(256), 44100).frequency_hz, 1500, 1e-2);
}

class Watching : public testing::Test {
 protected:
  std::vector<float> read(ObjectNumber object) {
    std::vector<float> amplitudes;
    return player_.mixer.meters().mode_watch.read(object, map_->bank(), amplitudes) ? amplitudes : std::vector<float>();
  }
  // What mode `mode` of amplitude `a` has decayed to; told up to kEvery_s and a chunk ago.
  static void expect_decayed(double told, std::size_t mode, double a, double frames) {
    EXPECT_LE(told, 1.0001 * a * std::exp(-kDecays_per_s[mode] * (frames / kRate - 0.02)));
    EXPECT_GE(told, 0.9999 * a * std::exp(-kDecays_per_s[mode] * frames / kRate));
  }

  Map map_ = four_modes();
  Player player_;
};

TEST_F(Watching, WatchingTellsTheAmplitudeOfEachModeAtTheObjectsGain) {
  player_.install(0, map_);
  ASSERT_TRUE(player_.mixer.meters().mode_watch.watch(0));
  EXPECT_TRUE(read(0).empty()) << "nothing was rendered yet";
  player_.push(gain_at(0, 0, 0.5));
  player_.push(pan_at(0, 0, -1));
  player_.push(ring_at(4800, 0, 1, 2, 0.2));
  player_.render(4800 + 24000);
  const auto told = read(0);
  ASSERT_EQ(told.size(), 4u);
  EXPECT_EQ(told[1], 0);
  EXPECT_EQ(told[2], 0);
  expect_decayed(told[3], 3, 0.1, 24000);
  expect_decayed(told[0], 0, 0.1, 24000);
  player_.mixer.meters().mode_watch.unwatch(0);
  EXPECT_TRUE(read(0).empty());
}

TEST_F(Watching, WatchingTellsEachObjectsOwnShareOfStatesThatAreShared) {
  const auto table = std::make_shared<ModeTable>(map_, modal::MaterialScale{}, kRate);
  for (ObjectNumber object = 0; object < 3; ++object) {
    ASSERT_TRUE(player_.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
    ASSERT_TRUE(player_.mixer.meters().mode_watch.watch(object));
  }
  player_.render(4800);
  player_.push(ring_at(4800, 0, 0, 1, 0.1));
  player_.push(ring_at(4800, 1, 3, 1, 0.3));
  player_.render(24000);
  expect_decayed(read(0)[1], 1, 0.1, 24000);
  expect_decayed(read(1)[2], 2, 0.3, 24000);
  EXPECT_EQ(read(0)[2], 0);
  EXPECT_EQ(read(1)[1], 0);
  EXPECT_EQ(read(2), std::vector<float>(4));
}

TEST_F(Watching, WatchingTellsZeroForModesThatTheObjectDoesNotHaveAndNothingOfAnotherBank) {
  ASSERT_TRUE(player_.mixer.install(0, voice_with(map_, {0, 1}), Mixer::Install::replace));
  ASSERT_TRUE(player_.mixer.meters().mode_watch.watch(0));
  player_.push(strike_at(0, 0, {0.1, 0.2, 0.3}));
  player_.render(4800);
  const auto told = read(0);
  ASSERT_EQ(told.size(), 4u);
  EXPECT_GT(told[1], 0);
  EXPECT_EQ(std::ranges::count(told, 0.0f), 3);
  player_.install(0, four_modes());
  player_.render(4800);
  EXPECT_TRUE(read(0).empty()) << "its bank is not the one that is asked about";
}

TEST_F(Watching, SixteenObjectsAreWatchedAtATimeAndNotOneMore) {
  ModeWatch& watch = player_.mixer.meters().mode_watch;
  for (ObjectNumber object = 0; object < kMaxWatched; ++object) EXPECT_TRUE(watch.watch(object));
  EXPECT_FALSE(watch.watch(kMaxWatched));
  EXPECT_TRUE(watch.watch(3)) << "that one is watched already";
  watch.unwatch(3);
  EXPECT_TRUE(watch.watch(kMaxWatched));
  EXPECT_FALSE(watch.watch(3));
}

TEST_F(Watching, NeitherWatchingNorRingingNorTheToneNorTheTapAllocatesOrWaits) {
  if (!kRealtimeGuardWorks) GTEST_SKIP() << "sanitizers and clang replace the watched functions";
  player_.install(0, map_);
  ASSERT_TRUE(player_.mixer.meters().mode_watch.watch(0));
  player_.mixer.sound_tap().watch(true);
  player_.mixer.test_tone().set(0.1, 440);
  player_.push(ring_at(0, 0, 0, 4, 0.1));
  const RealtimeScope scope;
  for (int i = 0; i < 1000; ++i) player_.mixer.render(Outputs(), 64);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
