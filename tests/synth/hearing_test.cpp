// What is left out because something louder hides it: how much that is, and that nothing is lost by it.
#include "engine/synth/hearing.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <cmath>
#include <random>

namespace ringdown::synth::test {
namespace {

EarBand at(double frequency_hz) { return ear_band_of(frequency_hz); }
Level level_at(double db) { return level_of(std::pow(10.0, 0.1 * db)); }

TEST(Hearing, LevelsAreDecibels) {
  for (double db = -150; db < 30; db += 0.37) EXPECT_NEAR(level_at(db) * kStep_db, db, kStep_db + 0.3);
}

TEST(Hearing, ALoudToneHidesAQuietOneNearIt) {
  Hearing hearing;
  hearing.note(at(1000), level_at(-10));
  hearing.note(at(1010), level_at(-45));
  const Cut cut = hearing.decide(true);
  EXPECT_TRUE(cut.passes(at(1000), level_at(-10)));
  EXPECT_FALSE(cut.passes(at(1010), level_at(-45)));
  EXPECT_FALSE(cut.passes(at(1010), level_at(-40)));
  EXPECT_TRUE(cut.passes(at(1010), level_at(-30))) << "25 dB below, beats can be heard";
  EXPECT_TRUE(cut.passes(at(4000), level_at(-80))) << "far away nothing is hidden";
}

TEST(Hearing, ManyQuietTonesTogetherAreNotHidden) {
  Hearing hearing;
  hearing.note(at(1000), level_at(-10));
  for (int i = 0; i < 10000; ++i) hearing.note(at(1000), level_at(-50));
  EXPECT_TRUE(hearing.decide(true).passes(at(1000), level_at(-50)));
}

TEST(Hearing, EqualTonesHideNoneOfThem) {
  Hearing hearing;
  for (int i = 0; i < 1000; ++i) hearing.note(at(20.0 * (i + 1)), level_at(-60));
  const Cut cut = hearing.decide(true);
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(cut.passes(at(20.0 * (i + 1)), level_at(-60)));
}

TEST(Hearing, WhatIsLeftOutOfABandLiesBelowWhatIsHiddenThere) {
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    Hearing hearing;
    std::vector<double> levels;
    for (int i = 0; i < 3000; ++i) levels.push_back(-120.0 * static_cast<double>(random()) / 4294967296.0);
    for (const double level : levels) hearing.note(at(700), level_at(level));
    const Cut cut = hearing.decide(true);
    double left_out = 0, loudest = -200;
    for (const double level : levels) {
      loudest = std::max(loudest, level);
      if (!cut.passes(at(700), level_at(level))) left_out += std::pow(10.0, 0.1 * level);
    }
    EXPECT_GT(left_out, 0);
    EXPECT_LT(10 * std::log10(left_out), loudest - 24);
  }
}

TEST(Hearing, WithoutMaskingEverythingPasses) {
  Hearing hearing;
  hearing.note(at(1000), level_at(0));
  const Cut cut = hearing.decide(false);
  EXPECT_FALSE(cut.hides);
  EXPECT_TRUE(cut.passes(at(1000), level_at(-160)));
}

// A loud mode that dies quickly, and beside it a quiet one that lasts.
constexpr ObjectNumber kLoud = 0, kQuiet = 1;
constexpr double kQuietDecay = 0.2;

struct Pair {
  explicit Pair(bool masking, double loud_ns = 3) {
    player.mixer.set_masking(masking, 0);
    player.install(kLoud, map_of(single_mode_bank(1000, 12)));
    player.install(kQuiet, map_of(single_mode_bank(1011, kQuietDecay)));
    player.push(strike_at(0, kLoud, {0, 0, loud_ns}));
    player.push(strike_at(0, kQuiet, {0, 0, 0.003 * loud_ns}));
  }
  [[nodiscard]] std::uint32_t hidden() const { return player.mixer.counters().hidden_modes.load(); }
  Player player;
};

Samples quiet_alone(double impulse_ns, std::size_t count) {
  return closed_form(1011, kQuietDecay, impulse_ns, 0, kRate, count);
}

TEST(Masking, WhatWasHiddenComesBackAsIfItHadNeverLeft) {
  Pair pair(true);
  pair.player.render(12000);
  EXPECT_GT(pair.hidden(), 0u);
  pair.player.render(132000);
  EXPECT_EQ(pair.hidden(), 0u);
  const Samples quiet = quiet_alone(0.009, 144000);
  // By then the loud one lies 310 dB down.
  EXPECT_LT(relative_error_db(pair.player.left_from(143000), std::span(quiet).subspan(143000)), -110);
}

TEST(Masking, StrikesOnWhatIsHiddenAreNotLost) {
  Pair pair(true);
  for (const Frame frame : {6000, 6100, 6400, 9001, 9001, 11003}) {
    pair.player.push(strike_at(frame, kQuiet, {0, 0, 0.002}));
  }
  pair.player.render(12000, 333);
  EXPECT_GT(pair.hidden(), 0u);
  pair.player.render(132000);
  Samples quiet = quiet_alone(0.009, 144000);
  for (const std::size_t frame : {6000, 6100, 6400, 9001, 9001, 11003}) {
    const Samples more = quiet_alone(0.002, 144000 - frame);
    for (std::size_t n = frame; n < quiet.size(); ++n) quiet[n] += more[n - frame];
  }
  EXPECT_LT(relative_error_db(pair.player.left_from(143000), std::span(quiet).subspan(143000)), -110);
}

TEST(Masking, AHardStrikeBringsItBackAtOnce) {
  Pair pair(true);
  pair.player.push(strike_at(12000, kQuiet, {0, 0, 3}));
  pair.player.render(12000);
  ASSERT_GT(pair.hidden(), 0u);
  pair.player.render(256);
  EXPECT_EQ(pair.hidden(), 0u);
  Pair plain(false);
  plain.player.push(strike_at(12000, kQuiet, {0, 0, 3}));
  plain.player.render(12256);
  EXPECT_LT(relative_error_db(pair.player.left_from(12000), plain.player.left_from(12000)), -40);
}

TEST(Masking, ComingAndGoingMakesNoClick) {
  Pair masked(true), plain(false);
  masked.player.render(144000);
  plain.player.render(144000);
  Samples difference(144000);
  for (std::size_t n = 0; n < difference.size(); ++n) difference[n] = masked.player.left[n] - plain.player.left[n];
  const double loudest = peak(difference);
  EXPECT_GT(loudest, 0.001 * peak(plain.player.left));
  // From sample to sample a sinusoid of that amplitude moves by 2 pi f / rate, and the fade by 1 / 128.
  const double smooth = 2 * std::numbers::pi * 1011 / kRate + 1.0 / 128;
  EXPECT_LT(largest_step(difference, 1, difference.size()), 1.1 * smooth * loudest);
}

TEST(Masking, DoesNotLookWhereFewModesRing) {
  Pair pair(false);
  pair.player.mixer.set_masking(true);
  pair.player.render(12000);
  EXPECT_EQ(pair.hidden(), 0u);
}

TEST(Masking, SwitchedOffItAllComesBack) {
  Pair pair(true);
  pair.player.render(12000);
  ASSERT_GT(pair.hidden(), 0u);
  pair.player.mixer.set_masking(false);
  pair.player.render(4096);
  EXPECT_EQ(pair.hidden(), 0u);
}

TEST(Masking, WhatIsHiddenCanBeClearedRetunedAndTakenAway) {
  Pair pair(true);
  pair.player.render(4000);
  ASSERT_GT(pair.hidden(), 0u);
  pair.player.install(kQuiet, map_of(single_mode_bank(1011, kQuietDecay)), Mixer::Install::retune);
  pair.player.render(4000);
  EXPECT_GT(pair.hidden(), 0u);
  pair.player.push(clear_at(8000, kQuiet));
  pair.player.render(4000);
  EXPECT_EQ(pair.hidden(), 0u);
  ASSERT_TRUE(pair.player.mixer.remove(kQuiet));
  pair.player.render(1000);
  pair.player.mixer.collect();
  EXPECT_FALSE(pair.player.mixer.in_use(kQuiet));
}

// A loud dense bank and three quiet ones, struck again and again.
struct Crowd {
  explicit Crowd(bool masking) {
    player.mixer.set_masking(masking, 0);
    for (ObjectNumber object = 0; object < 4; ++object) {
      player.install(object, map_of(random_bank(object + 1, 1000, 20)));
      const double loudness = object == 0 ? 1 : 0.002;
      for (Frame strike = 0; strike < 6; ++strike) {
        const Vec3 impulse{0.1 * loudness, 0.2 * loudness, -0.3 * loudness};
        player.push(strike_at(strike * 10011 + 777 * object, object, impulse, 0.0001));
      }
    }
  }
  Player player;
};

TEST(Masking, SavesWhatIsMuchQuieterAndLosesLittle) {
  Crowd masked(true), plain(false);
  std::uint64_t computed = 0, all = 0;
  for (int block = 0; block < 200; ++block) {
    masked.player.render(480, 480);
    plain.player.render(480, 480);
    computed += masked.player.mixer.counters().ringing_modes.load();
    all += plain.player.mixer.counters().ringing_modes.load();
  }
  const double share = static_cast<double>(computed) / static_cast<double>(all);
  const double error_db = relative_error_db(masked.player.left, plain.player.left);
  std::printf("computed %.3f of the modes, error %.1f dB\n", share, error_db);
  EXPECT_LT(share, 0.7);
  EXPECT_LT(error_db, -25);
}

TEST(Masking, DoesNothingThatAnAudioThreadMustNot) {
  Crowd crowd(true);
  std::vector<float> left(128), right(128);
  RealtimeViolations seen;
  bool hidden = false;
  for (int block = 0; block < 400; ++block) {
    {
      const RealtimeScope scope;
      crowd.player.mixer.render(left, right);
      if (seen.total() == 0) seen = scope.seen();
    }
    hidden = hidden || crowd.player.mixer.counters().hidden_modes.load() > 0;
  }
  EXPECT_TRUE(hidden);
  EXPECT_EQ(seen.total(), 0u) << seen.first;
}

// Objects that share a table, and so their states, beside a loud one.
TEST(Masking, WhatSharesStatesIsHiddenTogetherAndComesBack) {
  Player player[2];
  for (const bool masking : {false, true}) {
    Player& one = player[masking ? 1 : 0];
    one.mixer.set_masking(masking, 0);
    one.install(0, map_of(single_mode_bank(1000, 12)));
    one.push(strike_at(0, 0, {0, 0, 3}));
    const auto table =
        std::make_shared<ModeTable>(map_of(single_mode_bank(1011, kQuietDecay)), modal::MaterialScale{}, kRate);
    for (ObjectNumber object = 1; object < 4; ++object) {
      ASSERT_TRUE(one.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
      one.push(strike_at(100 * object, object, {0, 0, 0.002}));
      one.push(strike_at(7000 + 77 * object, object, {0, 0, 0.001}));
    }
    one.push(gain_at(9000, 2, 0.5, 0.02));  // leaves the others
    one.render(6400, 256);
    EXPECT_EQ(one.mixer.counters().hidden_modes.load() > 0, masking);
    one.render(137600, 333);
    EXPECT_EQ(one.mixer.counters().hidden_modes.load(), 0u);
  }
  EXPECT_LT(relative_error_db(player[1].left_from(143000), player[0].left_from(143000)), -100);
}

}  // namespace
}  // namespace ringdown::synth::test
