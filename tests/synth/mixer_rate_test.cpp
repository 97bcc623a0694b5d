// A mixer whose sample rate changes while things ring: in seconds and hertz nothing may change.
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

namespace ringdown::synth::test {
namespace {

constexpr double kPitch_hz = 987.5, kDecay_per_s = 3;

// One channel of a struck mode, from `time_s` after the strike on.
Samples expected(double time_s, double rate, std::size_t count) {
  const long double omega = 2 * std::numbers::pi_v<long double> * kPitch_hz;
  Samples samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    const long double t = time_s + static_cast<long double>(n) / rate;
    samples[n] = static_cast<double>(std::sqrt(0.5L) * ringdown::test::kLoudness * omega * std::exp(-kDecay_per_s * t) *
                                     std::sin(omega * t));
  }
  return samples;
}

double relative_error(std::span<const double> heard, const Samples& wanted) {
  double error = 0, largest = 0;
  for (std::size_t n = 0; n < wanted.size(); ++n) {
    error = std::max(error, std::abs(heard[n] - wanted[n]));
    largest = std::max(largest, std::abs(wanted[n]));
  }
  return error / largest;
}

class MixerRates : public testing::TestWithParam<double> {};

TEST_P(MixerRates, AToneGoesOnAtANewRateWherePhaseAndLoudnessWere) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, kDecay_per_s)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(24000);
  player.mixer.change_sample_rate(GetParam());
  EXPECT_EQ(player.mixer.sample_rate_hz(), GetParam());
  player.render(20000, 100);
  EXPECT_LT(relative_error(player.left_from(24000), expected(0.5, GetParam(), 20000)), 1e-5);
}

TEST_P(MixerRates, EventsOnTheirWayComeAsManySecondsLaterAtANewRate) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, kDecay_per_s)));
  player.render(1000);
  player.push(strike_at(1000 + 4800, 0, {0, 0, 1}));  // one in the mixer,
  player.mixer.render({}, {});
  player.push(strike_at(1000 + 9600, 0, {0, 0, 1}));  // one in the ring: after 0.1 s and 0.2 s
  player.mixer.change_sample_rate(GetParam());
  player.render(static_cast<std::size_t>(0.15 * GetParam()));
  EXPECT_EQ(player.mixer.counters().strikes, 1u);
  const auto first = 1000 + static_cast<std::size_t>(std::llround(0.1 * GetParam()));
  EXPECT_EQ(peak(std::span(player.left).first(first + 1)), 0);
  EXPECT_NE(player.left[first + 1], 0);
  player.render(static_cast<std::size_t>(0.1 * GetParam()));
  EXPECT_EQ(player.mixer.counters().strikes, 2u);
  EXPECT_EQ(player.mixer.counters().late, 0u);
}

TEST_P(MixerRates, ARampTakesAsLongAsItWasToTakeAtANewRate) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, 0.01)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.push(gain_at(0, 0, 0, 1));
  player.render(24000);
  player.mixer.change_sample_rate(GetParam());
  const auto quarter = static_cast<std::size_t>(0.25 * GetParam());
  player.render(quarter);
  const std::span<const double> last = player.left_from(24000 + quarter - 200);
  const double full = peak(std::span(player.left).first(200)), now = peak(last);
  EXPECT_NEAR(now / full, 0.25, 0.03);
  player.render(quarter + 2000);
  EXPECT_EQ(peak(player.left_from(24000 + 2 * quarter + 100)), 0);
}

INSTANTIATE_TEST_SUITE_P(Hz, MixerRates, testing::Values(44100, 96000, 48000, 22050));

TEST(MixerRate, TailsOfFormerBanksAndFadesGoOnAtANewRate) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, kDecay_per_s)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(24000);
  player.install(0, map_of(single_mode_bank(300, 1)));  // the first rings out as a tail
  player.render(256);
  player.mixer.change_sample_rate(44100);
  player.render(20000);
  EXPECT_LT(relative_error(player.left_from(24256), expected(24256 / kRate, 44100, 20000)), 1e-5);
  player.push(clear_at(player.mixer.counters().frames, 0));
  player.render(256);
  player.mixer.change_sample_rate(48000);
  player.render(2000);
  EXPECT_EQ(peak(player.left_from(player.left.size() - 1000)), 0);
  player.mixer.collect();
  EXPECT_TRUE(player.mixer.in_use(0));
}

TEST(MixerRate, ObjectsThatShareTheirStatesGoOnSharingAtANewRate) {
  Player player;
  const auto table =
      std::make_shared<ModeTable>(map_of(single_mode_bank(kPitch_hz, kDecay_per_s)), modal::MaterialScale{}, kRate);
  for (ObjectNumber object = 0; object < 3; ++object) {
    ASSERT_TRUE(player.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
  }
  for (ObjectNumber object = 0; object < 2; ++object) player.push(strike_at(0, object, {0, 0, 0.5}));
  player.render(24000);
  player.mixer.change_sample_rate(44100);
  player.render(20000);
  EXPECT_LT(relative_error(player.left_from(24000), expected(0.5, 44100, 20000)), 1e-5);

  player.push(clear_at(player.mixer.counters().frames, 0));
  player.push(clear_at(player.mixer.counters().frames, 1));
  player.render(1000);
  const Frame begin = player.mixer.counters().frames;
  for (ObjectNumber object = 0; object < 2; ++object) player.push(strike_at(begin, object, {0, 0, 0.5}));
  player.render(20000);
  EXPECT_LT(relative_error(player.left_from(static_cast<std::size_t>(begin)), expected(0, 44100, 20000)), 1e-5);
}

TEST(MixerRate, AContactThatLastsGoesOnAtANewRate) {
  const auto play = [](bool change) {
    auto player = std::make_unique<Player>();
    set(player->mixer, &MixerSettings::exact_contacts, true);
    player->install(0, map_of(single_mode_bank(100, 1)));
    player->push(strike_at(0, 0, {0, 0, 1}, 0.01));
    player->render(240);  // half of the contact
    if (change) player->mixer.change_sample_rate(2 * kRate);
    player->render(change ? 9600 : 4800);
    return player;
  };
  const auto changed = play(true), plain = play(false);
  const std::span<const double> twice = changed->left_from(240), once = plain->left_from(240);
  Samples every_other;
  for (std::size_t n = 0; n < twice.size(); n += 2) every_other.push_back(twice[n]);
  EXPECT_LT(relative_error(every_other, Samples(once.begin(), once.end())), 1e-2);
}

TEST(MixerRate, EventsOfOneFrameKeepTheirOrderEvenWhenTwoFramesBecomeOne) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, 0.01)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.push(gain_at(1001, 0, 0));  // at a quarter of the rate both come at frame 250: the later one counts
  player.push(gain_at(1000, 0, 1));
  player.mixer.change_sample_rate(kRate / 4);
  player.render(2000);
  EXPECT_EQ(peak(player.left_from(1500)), 0);
}

TEST(MixerRate, MoreWaitingEventsThanUsualSurviveAChangeOfRate) {
  Player player;
  player.install(0, map_of(single_mode_bank(kPitch_hz, kDecay_per_s)));
  for (std::size_t i = 0; i < kMaxPendingEvents; ++i) {
    player.push(strike_at(48000, 0, {0, 0, 1e-3}));
    if (i % 1000 == 0) player.mixer.render({}, {});
  }
  player.mixer.render({}, {});
  for (std::size_t i = 0; i < kQueueCapacity; ++i) player.push(strike_at(48000, 0, {0, 0, 1e-3}));
  player.mixer.change_sample_rate(96000);
  player.render(95999);
  EXPECT_EQ(player.mixer.counters().strikes, 0u);
  player.render(128 * (kMaxPendingEvents + kQueueCapacity) / kMaxEventsPerChunk + 256);
  EXPECT_EQ(player.mixer.counters().strikes, kMaxPendingEvents + kQueueCapacity);
}

}  // namespace
}  // namespace ringdown::synth::test
