// Banks that come and go while others ring: no click, no gap, no leftovers.
#include "tests/support/keep_signals.h"
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

namespace ringdown::synth::test {
namespace {

constexpr double kF = 440, kD = 4;

Map tone() { return map_of(single_mode_bank(kF, kD)); }

// A ringing tone, struck at frame 0 and rendered for `frames`.
std::unique_ptr<Player> ringing(std::size_t frames) {
  auto player = std::make_unique<Player>();
  player->install(0, tone());
  player->push(strike_at(0, 0, {0, 0, 1}));
  player->render(frames);
  return player;
}

TEST(Replace, AReplacedVoiceRingsOutExactlyAsItWouldHave) {
  const auto plain = ringing(20000);
  const auto swapped = ringing(5000);
  swapped->install(0, map_of(single_mode_bank(1000, 2)));
  swapped->render(15000);
  // Same blocks on both sides of the swap: 5000 is no multiple of the block size.
  const auto same_blocks = ringing(5000);
  same_blocks->render(15000);
  EXPECT_EQ(swapped->left, same_blocks->left);
  EXPECT_LT(relative_error_db(swapped->left, plain->left), -130);
}

TEST(Replace, ReplacingAVoiceSendsTheNextStrikeToTheNewBankBesideTheOldTail) {
  const auto player = ringing(5000);
  player->install(0, map_of(single_mode_bank(1000, 2)));
  player->push(strike_at(6000, 0, {0, 0, 0.5}));
  player->render(15000);
  Samples exact = closed_form(kF, kD, 1, 0, kRate, player->left.size());
  const Samples second = closed_form(1000, 2, 0.5, 0, kRate, exact.size() - 6000);
  for (std::size_t n = 0; n < second.size(); ++n) exact[6000 + n] += second[n];
  KeepSignals keep(kRate);
  keep.add("heard", player->left);
  keep.add("exact", exact);
  EXPECT_LT(relative_error_db(player->left, exact), -130);
}

TEST(Replace, ReplacingAVoiceMakesNoStepLargerThanTheRingingItself) {
  const auto player = ringing(5000);
  player->install(0, map_of(single_mode_bank(1000, 2)));
  player->render(5000);
  EXPECT_LE(largest_step(player->left, 4990, 5200), largest_step(player->left, 4800, 4990));
}

TEST(Replace, AReplacedVoiceIsGivenBackOnceItHasDied) {
  Player player;
  const std::weak_ptr<const modal::StrikeMap> watch = [&player] {
    const Map map = map_of(single_mode_bank(1000, 200));
    player.install(0, map);
    return map;
  }();
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(100);
  player.install(0, tone());
  player.render(100);
  player.mixer.collect();
  EXPECT_FALSE(watch.expired()) << "it still rings";
  player.render(10000);
  EXPECT_FALSE(watch.expired()) << "the audio thread frees nothing";
  player.mixer.collect();
  EXPECT_TRUE(watch.expired());
  EXPECT_TRUE(player.mixer.in_use(0));
}

TEST(Replace, ASilentVoiceThatIsReplacedIsGivenBackAtOnce) {
  Player player;
  const Map map = tone();
  player.install(0, map);
  player.render(64);
  player.install(0, tone());
  player.render(64);
  player.mixer.collect();
  EXPECT_EQ(map.use_count(), 1);
}

// Stiffness times 1.21 raises the pitch by 1.1 at once; phase and amplitude go on from where they were.
TEST(Retune, RetuningContinuesPhaseAndAmplitudeAtTheNewPitch) {
  constexpr std::size_t kChange = 5000;
  modal::Bank bank = single_mode_bank(kF, kD);
  const auto player = ringing(kChange);
  const Map map = map_of(bank);
  player->install(0, map, Mixer::Install::retune, {.stiffness = 1.21});
  player->render(20000 - kChange);

  // Without a material all damping is mass-proportional: d stays, lambda = omega^2 + d^2 grows by 1.21.
  const double omega = 2 * std::numbers::pi * kF, lambda = 1.21 * (omega * omega + kD * kD);
  const double new_f = std::sqrt(lambda - kD * kD) / (2 * std::numbers::pi);
  EXPECT_NEAR(new_f, 1.1 * kF, 1e-3);
  Samples exact = closed_form(kF, kD, 1, 0, kRate, 20000);
  const double level = std::numbers::sqrt2 / 2 * ringdown::test::kLoudness * omega;
  for (std::size_t n = kChange; n < exact.size(); ++n) {
    const double phase =
        omega * kChange / kRate + 2 * std::numbers::pi * new_f * static_cast<double>(n - kChange) / kRate;
    exact[n] = level * std::exp(-kD * static_cast<double>(n) / kRate) * std::sin(phase);
  }
  KeepSignals keep(kRate);
  keep.add("heard", player->left);
  keep.add("exact", exact);
  EXPECT_LT(relative_error_db(player->left, exact), -120);
  const auto after = fit_damped_sinusoid(player->left_from(kChange), kRate);
  EXPECT_NEAR(after.frequency_hz, new_f, 1e-4);
  EXPECT_LE(largest_step(player->left, kChange - 5, kChange + 5), 1.1 * largest_step(player->left, 4500, kChange));
}

TEST(Retune, RetuningThereAndBackIsTheOldPitch) {
  const auto player = ringing(1000);
  const Map map = tone();
  player->install(0, map, Mixer::Install::retune, {.alpha = 0.5, .density = 3});
  player->render(1000);
  player->install(0, map, Mixer::Install::retune);
  player->render(20000);
  const auto back = fit_damped_sinusoid(player->left_from(2100), kRate);
  EXPECT_NEAR(back.frequency_hz, kF, 1e-4);
  EXPECT_NEAR(back.decay_per_s, kD, 1e-3);
}

TEST(Retune, RetuningKeepsAFadeGoing) {
  const auto player = ringing(1000);
  player->push(clear_at(1000, 0));
  player->render(100);
  player->install(0, tone(), Mixer::Install::retune, {.stiffness = 1.1});
  player->render(1000);
  EXPECT_GT(peak(std::span(player->left).subspan(1100, 300)), 0);
  EXPECT_EQ(peak(player->left_from(1000 + FadeOut::kMinFrames + 1)), 0);
}

// A hand lets the amplitude fall by 60 dB in the time, on top of its own decay.
TEST(Choke, WhatRingsFallsExponentiallyByAThousandthInTheTime) {
  const auto player = ringing(5000);
  player->push({5000, 0, verb::Choke{0.25}});
  player->render(12100);
  const auto choked = fit_damped_sinusoid(std::span(player->left).subspan(5000, 6000), kRate);
  EXPECT_NEAR(choked.frequency_hz, kF, 1e-3);
  EXPECT_NEAR(choked.decay_per_s, kD + std::log(1000) / 0.25, 1e-3 * choked.decay_per_s);
  EXPECT_LE(largest_step(player->left, 4990, 17000), 1.01 * largest_step(player->left, 4500, 5000));
  EXPECT_EQ(peak(player->left_from(5000 + 12000)), 0);
}

TEST(Choke, StrikesThatFollowAndBowsThatGoOnRingInFull) {
  const auto struck = [](bool choked) {
    Player player;
    player.install(0, tone());
    if (choked) {
      player.push(strike_at(0, 0, {0, 0, 1}));
      player.push({1000, 0, verb::Choke{0.02}});
    }
    player.push(strike_at(1100, 0, {0, 0, 1}));
    player.render(6000);
    return player.left;
  };
  const Samples both = struck(true), alone = struck(false);
  EXPECT_LT(relative_error_db(std::span(both).subspan(2500), std::span(alone).subspan(2500)), -120);
  const auto slid = [](bool choked) {
    Player player;
    player.install(0, tone());
    const Contact contact{.force_n = {0, 0, -1}, .slip_m_s = 0.2};
    for (Frame frame = 0; frame < 48000; frame += 480) player.push({frame, 0, verb::Contact{{1, 1, 1}, contact}});
    if (choked) player.push({24000, 0, verb::Choke{0.05}});
    player.render(48000);
    return peak(player.left_from(40000));
  };
  EXPECT_NEAR(slid(true) / slid(false), 1, 0.5) << "the contact goes on";
}

TEST(Clear, ClearingTakesAsLongAsItIsTold) {
  const auto player = ringing(5000);
  const double level = peak(player->left_from(4500));
  player->push(clear_at(5000, 0, 0.25));
  player->render(12100);
  EXPECT_LE(largest_step(player->left, 4990, 17000), 1.01 * largest_step(player->left, 4500, 5000));
  EXPECT_GT(peak(player->left_from(5000 + 11500)), 1e-3 * level);
  EXPECT_EQ(peak(player->left_from(5000 + 12000)), 0);
}

TEST(Clear, AClearedObjectFadesToSilenceWithoutAClickAndOnTime) {
  const auto player = ringing(5000);
  const double step_before = largest_step(player->left, 4500, 5000), level = peak(player->left_from(4500));
  player->push(clear_at(5000, 0));
  player->render(2000);
  KeepSignals keep(kRate);
  keep.add("heard", player->left);
  EXPECT_LE(largest_step(player->left, 4990, 7000), step_before + level / FadeOut::kMinFrames);
  EXPECT_GT(peak(std::span(player->left).subspan(5200, 100)), 0.1 * level) << "a fade, not a cut";
  EXPECT_EQ(peak(player->left_from(5000 + FadeOut::kMinFrames)), 0);
  EXPECT_EQ(player->mixer.counters().ringing_voices, 0u);
}

TEST(Clear, ClearingDoesNotAffectTheStrikesThatFollow) {
  const auto player = ringing(5000);
  player->push(clear_at(5000, 0));
  player->push(strike_at(5100, 0, {0, 0, 1}));
  player->render(5000);
  const Samples exact = closed_form(kF, kD, 1, 0, kRate, 4000);
  const std::size_t faded = FadeOut::kMinFrames;
  EXPECT_LT(relative_error_db(player->left_from(5100 + faded), std::span(exact).subspan(faded)), -120);
}

TEST(Clear, ClearingInsideAFadeMakesNoClick) {
  const auto player = ringing(5000);
  const double step_before = largest_step(player->left, 4500, 5000), level = peak(player->left_from(4500));
  for (const Frame frame : {5000, 5100, 5200}) player->push(clear_at(frame, 0));
  player->render(2000);
  EXPECT_LE(largest_step(player->left, 4990, 7000), step_before + level / FadeOut::kMinFrames);
  EXPECT_EQ(peak(player->left_from(5200 + FadeOut::kMinFrames)), 0);
}

TEST(Remove, RemovingAnObjectFadesLikeClearing) {
  const auto player = ringing(5000);
  const double step_before = largest_step(player->left, 4500, 5000), level = peak(player->left_from(4500));
  ASSERT_TRUE(player->mixer.remove(0));
  player->render(2000);
  EXPECT_LE(largest_step(player->left, 4990, 7000), step_before + level / FadeOut::kMinFrames);
  EXPECT_EQ(peak(player->left_from(5000 + FadeOut::kMinFrames)), 0);
}

// Banks replaced earlier still ring: they belong to the object too.
TEST(Remove, RemovingAnObjectFadesTheTailsOfEarlierBanksToo) {
  const auto player = ringing(1000);
  player->install(0, map_of(single_mode_bank(1000, 2)));
  player->render(1000);
  ASSERT_TRUE(player->mixer.remove(0));
  player->render(2000);
  EXPECT_EQ(peak(player->left_from(2000 + FadeOut::kMinFrames)), 0);
  player->mixer.collect();
  EXPECT_FALSE(player->mixer.in_use(0));
}

TEST(Remove, RemovingTwiceOrNothingIsHarmless) {
  const auto player = ringing(100);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(player->mixer.remove(0));
  ASSERT_TRUE(player->mixer.remove(7));
  player->render(2000);
  player->mixer.collect();
  EXPECT_FALSE(player->mixer.in_use(0));
  EXPECT_FALSE(player->mixer.in_use(7));
}

TEST(Remove, RemovingAnObjectFreesTheNumberWithItsGainAndPanReset) {
  Player used, fresh;
  used.install(5, map_of(single_mode_bank(900, 3)));
  used.push(gain_at(0, 5, 0.1));
  used.push(pan_at(0, 5, -1));
  used.push(strike_at(0, 5, {0, 0, 1}));
  used.render(1000);
  ASSERT_TRUE(used.mixer.remove(5));
  EXPECT_TRUE(used.mixer.in_use(5));
  used.render(1024);
  used.mixer.collect();
  ASSERT_FALSE(used.mixer.in_use(5));

  fresh.render(2024);
  for (Player* player : {&used, &fresh}) {
    player->install(5, tone());
    player->push(strike_at(2024, 5, {0, 0, 1}));
    player->render(5000);
  }
  for (std::size_t n = 2024; n < fresh.left.size(); ++n) {
    ASSERT_EQ(used.left[n], fresh.left[n]) << n;
    ASSERT_EQ(used.right[n], fresh.right[n]) << n;
  }
}

// An object that never rang has nothing to fade, and still its number comes back with gain and pan reset.
TEST(Remove, RemovingASilentObjectResetsItToo) {
  Player player;
  player.install(0, tone());
  player.push(gain_at(0, 0, 0));
  player.render(1000);
  ASSERT_TRUE(player.mixer.remove(0));
  player.render(1024);
  player.mixer.collect();
  ASSERT_FALSE(player.mixer.in_use(0));
  player.install(0, tone());
  player.push(strike_at(2024, 0, {0, 0, 1}));
  player.render(1000);
  EXPECT_GT(peak(player.left_from(2024)), 0.01);
}

TEST(Remove, StrikesOnARemovedObjectAreRefusedAndCounted) {
  const auto player = ringing(100);
  ASSERT_TRUE(player->mixer.remove(0));
  player->push(strike_at(5000, 0, {0, 0, 1}));
  player->render(8000);
  EXPECT_EQ(peak(player->left_from(5000)), 0);
  EXPECT_EQ(player->mixer.counters().refused, 1u);
}

}  // namespace
}  // namespace ringdown::synth::test
