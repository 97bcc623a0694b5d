// What a strike sounds like, measured from samples: pitch, T60 and amplitude against the closed form.
#include "tests/support/keep_signals.h"
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace ringdown::synth::test {
namespace {

Samples play_one(double f, double d, Vec3 impulse, double contact_time, double rate, std::size_t frames, Frame at = 0) {
  Player player(rate);
  player.install(0, map_of(single_mode_bank(f, d)));
  player.push(strike_at(at, 0, impulse, contact_time));
  player.render(static_cast<std::size_t>(at) + frames);
  return Samples(player.left.begin() + at, player.left.end());
}

TEST(StruckMode, AStruckModeHasThePitchT60AndAmplitudeOfTheClosedForm) {
  for (const double f : {30.0, 261.626, 1234.5, 9000.0, 19999.0}) {
    for (const double t60 : {0.2, 3.0, 60.0}) {
      for (const double contact : {0.0, 1e-4, 0.0021}) {
        const double d = std::log(1000.0) / t60;
        // Loud (there is no clipping inside), so that the fit is not disturbed where the voice stops at -120 dB.
        const Samples heard = play_one(f, d, {0.3, -0.2, 5e4}, contact, kRate, 24000, 100);
        KeepSignals keep(kRate);
        keep.add("heard", heard);
        const auto mode = fit_damped_sinusoid(heard, kRate);
        const double expected = std::numbers::sqrt2 / 2 * ringdown::test::kLoudness * 2 * std::numbers::pi * f * 5e4 *
                                static_cast<double>(pulse_factor(f, contact));
        EXPECT_NEAR(mode.frequency_hz, f, 1e-6 * f);
        EXPECT_NEAR(mode.t60_s(), t60, 2e-4 * t60) << f;
        EXPECT_NEAR(mode.sine, expected, 1e-5 * std::abs(expected)) << f << " Hz, contact " << contact;
        EXPECT_NEAR(mode.cosine, 0, 1e-5 * std::abs(expected));
        ASSERT_FALSE(HasFailure());
      }
    }
  }
}

// A frequency in Hz used as rad/s would make this 2 pi too long or too short.
TEST(StruckMode, AStruckModeFallsBySixtyDecibelsInExactlyLn1000OverD) {
  const double d = 10, t60 = std::log(1000.0) / d;
  const Samples heard = play_one(1000, d, {0, 0, 1e3}, 0, kRate, 48000);
  // Energy over ten whole periods, so that the phase does not matter.
  const auto level = [&heard](double t) {
    double sum = 0;
    for (const double s : std::span(heard).subspan(static_cast<std::size_t>(std::lround(t * kRate)), 480)) sum += s * s;
    return std::sqrt(sum);
  };
  for (const double t : {0.0, 0.05, 0.1, 0.2}) EXPECT_NEAR(level(t) / level(t + t60), 1000, 1);
}

TEST(StruckMode, AStruckModeIsTheClosedFormSampleBySample) {
  double worst = -400;
  for (const double rate : {44100.0, 48000.0, 96000.0, 192000.0}) {
    for (const double f : {40.0, 3333.3, 20000.0}) {
      const Samples heard = play_one(f, 12, {0, 0, 1e5}, 3e-4, rate, 48000, 77);
      const Samples exact = closed_form(f, 12, 1e5, 3e-4, rate, heard.size());
      KeepSignals keep(rate);
      keep.add("heard", heard);
      keep.add("exact", exact);
      const double error = relative_error_db(heard, exact);
      worst = std::max(worst, error);
      EXPECT_LT(error, -130) << f << " Hz at " << rate;
    }
  }
  std::printf("struck mode against the closed form: worst error %.1f dB (float output)\n", worst);
}

TEST(StruckMode, AStruckModeKeepsPitchAndDecayAtEverySampleRate) {
  for (const double rate : {22050.0, 44100.0, 48000.0, 88200.0, 96000.0, 192000.0}) {
    const auto mode =
        fit_damped_sinusoid(play_one(5000, 20, {0, 0, 1}, 1e-4, rate, static_cast<std::size_t>(rate / 4)), rate);
    EXPECT_NEAR(mode.frequency_hz, 5000, 1e-3) << rate;
    EXPECT_NEAR(mode.decay_per_s, 20, 1e-3) << rate;
  }
}

TEST(StruckMode, AStruckModeDependsOnTheImpulseAlongItsShapeOnly) {
  Player across, along;
  across.install(0, map_of(single_mode_bank(500, 5, {0.6f, 0, 0.8f})));
  along.install(0, map_of(single_mode_bank(500, 5, {0.6f, 0, 0.8f})));
  across.push(strike_at(0, 0, {0.8, 5, -0.6}));
  along.push(strike_at(0, 0, {0.6, 5, 0.8}));
  across.render(1000);
  along.render(1000);
  EXPECT_LT(peak(across.left), 1e-7 * peak(along.left) + 1e-7);
}

TEST(StruckMode, AModeAtNyquistOrAboveIsLeftOut) {
  Player player(kRate);
  player.install(0, map_of(single_mode_bank(24000, 5)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(1000);
  EXPECT_EQ(peak(player.left), 0);
  EXPECT_GT(peak(play_one(23999, 5, {0, 0, 1}, 0, kRate, 1000)), 0);
}

TEST(StruckMode, AModeOverdampedByAMaterialIsLeftOut) {
  modal::Bank bank = bar_bank(3);
  const Map map = map_of(bank);
  const auto voice = voice_of(map, kRate, {.alpha = 1e6});
  EXPECT_EQ(voice->table().playable_modes(), 0u);
  EXPECT_EQ(voice_of(map)->table().playable_modes(), 3u);
}

TEST(Gain, GainAndPanScaleTheClosedForm) {
  for (const double pan : {-1.0, -0.3, 0.0, 0.8, 1.0}) {
    Player player;
    player.install(0, map_of(single_mode_bank(700, 3)));
    player.push(gain_at(0, 0, 0.25));
    player.push(pan_at(0, 0, pan));
    player.push(strike_at(4800, 0, {0, 0, 1}));
    player.render(20000);
    const double angle = (1 + pan) * std::numbers::pi / 4;
    for (const auto& [heard, side] : {std::pair{&player.left, std::cos(angle)}, {&player.right, std::sin(angle)}}) {
      const Samples exact = closed_form(700, 3, 1, 0, kRate, 15200, 0.25 * side);
      const double loudest = peak(exact);
      for (std::size_t n = 0; n < exact.size(); ++n) {
        ASSERT_NEAR((*heard)[4800 + n], exact[n], 1e-6 * loudest + 1e-9) << pan;
      }
    }
  }
}

TEST(Gain, GainMovesInAStraightLineFromItsFrameOn) {
  Player plain, ramped;
  for (Player* player : {&plain, &ramped}) {
    player->install(0, map_of(single_mode_bank(700, 1)));
    player->push(strike_at(0, 0, {0, 0, 1}));
  }
  ramped.push(gain_at(1000, 0, 3, 0.1));
  plain.render(10000);
  ramped.render(10000);
  for (std::size_t n = 0; n < plain.left.size(); ++n) {
    const double t = std::clamp((static_cast<double>(n) - 1000) / 4800, 0.0, 1.0);
    ASSERT_NEAR(ramped.left[n], (1 + 2 * t) * plain.left[n], 1e-6) << n;
  }
}

// Two strikes at different times, points and contact times sound as the sum of each alone.
TEST(Superposition, SuperpositionHoldsForStrikesOnOneRingingObject) {
  const Map map = map_of(random_bank(3, 100, 60));
  const Event first = strike_at(10, 0, {0.1, 0.2, -0.1}, 2e-4, {0.1, 0, 0});
  const Event second = strike_at(2345, 0, {-0.2, 0.1, 0.3}, 1e-3, {0, -0.1, 0.05});
  Samples runs[3];
  for (int run = 0; run < 3; ++run) {
    Player player;
    player.install(0, map);
    if (run != 1) player.push(first);
    if (run != 0) player.push(second);
    player.render(20000);
    runs[run] = player.left;
  }
  for (std::size_t n = 0; n < runs[0].size(); ++n) runs[0][n] += runs[1][n];
  KeepSignals keep(kRate);
  keep.add("both", runs[2]);
  keep.add("sum", runs[0]);
  const double error = relative_error_db(runs[2], runs[0]);
  std::printf("superposition: %.1f dB\n", error);
  EXPECT_LT(error, -130);
}

TEST(Superposition, TheSoundIsLinearInTheImpulse) {
  const Map map = map_of(random_bank(4, 50, 30));
  Samples runs[2];
  for (int run = 0; run < 2; ++run) {
    Player player;
    player.install(0, map);
    player.push(strike_at(10, 0, (run == 0 ? 1.0 : -8.0) * Vec3{0.01, 0.02, 0.03}, 1e-4, {0, 0.1, 0}));
    player.render(9600);
    runs[run] = player.left;
  }
  for (double& sample : runs[0]) sample *= -8;
  EXPECT_LT(relative_error_db(runs[1], runs[0]), -130);
}

TEST(Superposition, SuperpositionHoldsForObjects) {
  const Map maps[] = {map_of(random_bank(5, 40, 30)), map_of(random_bank(6, 40, 30))};
  Samples sum(9600, 0.0);
  Player both;
  for (ObjectNumber object = 0; object < 2; ++object) {
    Player alone;
    const Event event = strike_at(100 + 50 * object, object, {0.1, 0, 0.1}, 0, {0, 0.1, 0});
    for (Player* player : {&alone, &both}) {
      player->install(object, maps[object]);
      player->push(event);
    }
    alone.render(sum.size());
    for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += alone.left[n];
  }
  both.render(sum.size());
  EXPECT_LT(relative_error_db(both.left, sum), -130);
}

}  // namespace
}  // namespace ringdown::synth::test
