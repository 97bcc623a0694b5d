// Numbers that no sender should send, tails that die, and objects that are silent.
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <limits>

namespace ringdown::synth::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

// Object 0 rings undisturbed; `poison` goes to object 1, which rings too.
struct Poisoned {
  Player player;
  bool bystander_unharmed = false;

  explicit Poisoned(const Event& poison) {
    Player healthy;
    for (Player* p : {&player, &healthy}) {
      p->install(0, map_of(single_mode_bank(440, 4)));
      p->push(strike_at(0, 0, {0, 0, 1}));
    }
    player.install(1, map_of(random_bank(1, 37, 20)));
    player.push(pan_at(0, 1, 1));  // to the right: the left channel is the bystander's
    player.push(strike_at(4000, 1, {0.001, 0, 0}));
    player.render(4500);
    player.push(poison);
    player.render(4500);
    healthy.render(4500);
    healthy.render(4500);
    bystander_unharmed = true;
    for (std::size_t n = 0; n < healthy.left.size(); ++n) {
      const bool finite = std::isfinite(player.left[n]) && std::isfinite(player.right[n]);
      if (!finite || std::abs(player.left[n] - healthy.left[n]) > 1e-7) bystander_unharmed = false;
    }
  }
};

TEST(AbsurdInput, AnAbsurdStrikeSilencesItsOwnObjectOnlyAndIsCounted) {
  for (const double bad : {kNan, kInf, -kInf, 1e300, 1e150, 1e40}) {
    Poisoned run(strike_at(4600, 1, {bad, 0, 0.1}));
    EXPECT_TRUE(run.bystander_unharmed) << "impulse " << bad;
    EXPECT_EQ(run.player.mixer.counters().not_finite, 1u) << "impulse " << bad;

    const std::size_t now = run.player.left.size();
    EXPECT_EQ(run.player.mixer.counters().ringing_voices, 1u);
    run.player.push(strike_at(static_cast<Frame>(now), 1, {0, 0, 0.1}));
    run.player.render(1000);
    EXPECT_EQ(run.player.mixer.counters().ringing_voices, 2u) << "the object plays again after " << bad;
    EXPECT_EQ(run.player.mixer.counters().not_finite, 1u);
  }
}

TEST(AbsurdInput, AnAbsurdStrikeOnASingleModeIsFoundToo) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 4)));
  player.push(strike_at(0, 0, {0, 0, kNan}));
  player.render(1000);
  EXPECT_EQ(player.mixer.counters().not_finite, 1u);
  EXPECT_EQ(peak(player.left), 0);
  for (const double sample : player.left) ASSERT_TRUE(std::isfinite(sample));
}

TEST(AbsurdInput, AnAbsurdStrikeOnModesThatDieWithinAChunkIsFoundToo) {
  modal::Bank with_a_slow_one = single_mode_bank(440, 1e5);  // which is not struck
  with_a_slow_one.frequency_hz.push_back(500);
  with_a_slow_one.decay_per_s.push_back(1);
  with_a_slow_one.radiation->maps.modes.push_back(ringdown::test::even_field(500));
  with_a_slow_one.shapes.insert(with_a_slow_one.shapes.end(), 4, {1, 0, 0});
  for (const Map& map : {map_of(single_mode_bank(440, 1e5)), map_of(with_a_slow_one)}) {
    for (const double bad : {kNan, 1e300, 1e40, 1e30, 1e20}) {
      Player player;
      player.install(0, map);
      player.push(strike_at(0, 0, {0, 0, bad}));
      player.render(1000, 128);
      EXPECT_EQ(player.mixer.counters().not_finite, 1u) << bad;
      EXPECT_EQ(peak(player.left), 0) << bad;
    }
  }
}

TEST(AbsurdInput, AnAbsurdContactTimeOrPointDoesNotSpread) {
  for (const double bad : {kNan, kInf, 1e300, -1.0}) {
    EXPECT_TRUE(Poisoned(strike_at(4600, 1, {0, 0, 0.001}, bad)).bystander_unharmed) << "contact time " << bad;
    EXPECT_TRUE(Poisoned(strike_at(4600, 1, {0, 0, 0.001}, 0, {bad, bad, 0})).bystander_unharmed) << "point " << bad;
  }
}

TEST(AbsurdInput, AnAbsurdStrikeClearedInItsFrameDoesNotSpread) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 4)));
  player.push(strike_at(0, 0, {0, 0, kNan}));
  player.push(clear_at(0, 0));
  player.render(2000);
  for (const double sample : player.left) ASSERT_TRUE(std::isfinite(sample));
  EXPECT_EQ(player.mixer.counters().not_finite, 1u);
}

TEST(AbsurdInput, AnAbsurdGainPanOrRampIsRefused) {
  for (const double bad : {kNan, kInf, -kInf, 1e300}) {
    for (const Event& event : {gain_at(4600, 1, bad), pan_at(4600, 1, bad)}) {
      const Poisoned run(event);
      EXPECT_TRUE(run.bystander_unharmed) << bad;
      EXPECT_EQ(run.player.mixer.counters().refused, 1u) << bad;
    }
    EXPECT_TRUE(Poisoned(gain_at(4600, 1, 0.5, bad)).bystander_unharmed) << "ramp " << bad;
  }
}

TEST(AbsurdInput, AStrikeAtAnAbsurdFrameIsPlayedAtOnceOrNever) {
  const Poisoned past(strike_at(std::numeric_limits<Frame>::min(), 1, {0.001, 0, 0}));
  EXPECT_TRUE(past.bystander_unharmed);
  EXPECT_EQ(past.player.mixer.counters().late, 1u);
  const Poisoned future(strike_at(std::numeric_limits<Frame>::max(), 1, {0.001, 0, 0}));
  EXPECT_TRUE(future.bystander_unharmed);
  EXPECT_EQ(future.player.mixer.counters().strikes, 2u);
}

TEST(Silence, AVoiceThatHasDiedAwayLeavesTheActiveSet) {
  Player player;
  player.install(0, map_of(random_bank(2, 30, 20)));
  player.render(256);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
  player.push(strike_at(256, 0, {0.1, 0.1, 0}));
  player.render(2560);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 1u);
  EXPECT_EQ(player.mixer.counters().ringing_modes, 30u);
  EXPECT_GT(player.mixer.counters().peak, 0.0f);
  player.render(20 * 48000, 4096);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
  EXPECT_EQ(player.mixer.counters().ringing_modes, 0u);
  EXPECT_EQ(player.mixer.counters().peak, 0.0f);
}

// The tail is cut only below -120 dB of full scale.
TEST(Silence, SilenceBeginsBelowMinus120Decibels) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 20)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.render(48000 * 2);
  const Samples exact = closed_form(1000, 20, 1, 0, kRate, player.left.size());
  for (std::size_t n = 0; n < exact.size(); ++n) ASSERT_NEAR(player.left[n], exact[n], 1e-6);
  EXPECT_EQ(player.left.back(), 0);
}

TEST(Silence, AGainOrPanEventDoesNotWakeAnObject) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 20)));
  player.push(gain_at(0, 0, 2));
  player.push(pan_at(10, 0, 1));
  player.render(64);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
  EXPECT_EQ(peak(player.left), 0);
}

// Long after it rested, at a gain that would make its last state loud.
TEST(Silence, ModesThatRestAreForgotten) {
  const Map map = map_of(random_bank(2, 400, 20));  // enough modes for moments
  const Event none = vertex_strike_at(50 * 48000, 0, 1, {0, 0, 0});
  for (const Event& waking : {none, clear_at(50 * 48000, 0)}) {
    for (const std::size_t block : {8192, 32}) {
      Player player;
      player.install(0, map);
      player.push(vertex_strike_at(0, 0, 1, {0.01, 0, 0}));
      player.push(gain_at(40 * 48000, 0, 1e6));
      player.push(waking);
      player.render(50 * 48000, block);
      ASSERT_EQ(player.mixer.counters().ringing_modes, 0u);
      player.render(2000, block);
      EXPECT_EQ(peak(player.left_from(40 * 48000)), 0);
    }
  }
}

// The audio thread flushes denormals: a sound scaled below the smallest normal float comes out as zero, not as a
// denormal.
TEST(Silence, TheMixerNeverHandsDenormalsToTheSoundCard) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 20)));
  player.push(gain_at(0, 0, 1e-37));
  player.push(strike_at(1000, 0, {0, 0, 1}));
  player.render(48000);
  std::size_t normal = 0;
  for (const double sample : player.left_from(1000)) {
    ASSERT_FALSE(sample != 0 && std::abs(sample) < static_cast<double>(std::numeric_limits<float>::min())) << sample;
    normal += sample != 0;
  }
  EXPECT_GT(normal, 10u) << "the gain was small enough to silence everything: the test shows nothing";
}

}  // namespace
}  // namespace ringdown::synth::test
