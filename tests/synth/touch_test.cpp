// Two-way contacts in the mixer: bows, mallets and couplings against a simulation of their own, and among other sounds.
#include "tests/support/realtime_guard.h"
#include "tests/synth/leapfrog_bank.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

namespace ringdown::synth::test {
namespace {

constexpr Vec3 kBarEnd{0.15, 0, 0}, kUpward{0, 0, 1}, kDownward{0, 0, -1};

Touch mallet_with(double speed, double kg, double stiffness, double bounce = 1) {
  return {.kind = Touch::Kind::mallet,
          .direction = kDownward,
          .speed_m_s = speed,
          .mass_kg = kg,
          .stiffness = stiffness,
          .bounce = bounce};
}
Touch bow_with(double speed, double force, double rosin = 0.8) {
  return {.kind = Touch::Kind::bow, .direction = kUpward, .speed_m_s = speed, .force_n = force, .friction = rosin};
}

// What a bank that a mass hits sounds like.
Samples simulated_mallet(const modal::StrikeMap& map, Vec3 point_m, const Touch& mallet, std::size_t frames) {
  LeapfrogBank bank(map, point_m, mallet.direction);
  double x = 0, speed = mallet.speed_m_s, force = 0;
  Samples samples(frames);
  for (double& sample : samples) {
    sample = bank.sample(force);
    for (int s = 0; s < LeapfrogBank::kSteps; ++s) {
      const double depth = x - bank.displacement_m();
      force = depth > 0 ? mallet.stiffness * std::pow(depth, 1.5) : 0.0;
      speed -= LeapfrogBank::kStep_s * force / mallet.mass_kg;
      x += LeapfrogBank::kStep_s * speed;
      bank.step(force);
    }
  }
  return samples;
}

double off_by_db(std::span<const double> a, std::span<const double> b) {
  double square = 0, difference = 0;
  for (std::size_t n = 0; n < a.size(); ++n) square += a[n] * a[n], difference += (a[n] - b[n]) * (a[n] - b[n]);
  return 10 * std::log10(difference / square);
}

TEST(Touches, AMalletFeelsTheBarAsAFineSimulationDoes) {
  const Map map = map_of(bar_bank(8));
  for (const double stiffness : {1e5, 1e7, 1e8}) {
    const Touch hit = mallet_with(1, 0.03, stiffness);
    Player player;
    player.install(0, map);
    player.push(touch_at(100, 0, kBarEnd, hit));
    player.render(4800);
    const Samples expected = simulated_mallet(*map, kBarEnd, hit, 2400);
    EXPECT_LT(off_by_db(expected, player.left_from(100).first(expected.size())), -40) << stiffness;
    EXPECT_EQ(player.mixer.counters().refused, 0u);
    RecordProperty("db_" + std::to_string(static_cast<int>(std::log10(stiffness))),
                   std::to_string(off_by_db(expected, player.left_from(100).first(expected.size()))));
  }
}

TEST(Touches, WhatTouchesNothingStaysAsItIsToTheBit) {
  const Map map = map_of(random_bank(3, 100, 60));
  const auto play = [&](bool touched) {
    Player player;
    player.install(0, map);
    player.install(1, map_of(bar_bank(8)));
    set(player.mixer, &MixerSettings::floor_db, 200);
    player.push(strike_at(50, 0, {0.1, 0, 0.02}));
    if (touched) player.push(touch_at(300, 1, kBarEnd, bow_with(0.2, 0)));
    player.render(9600);
    return player.left;
  };
  EXPECT_EQ(play(false), play(true));
}

TEST(Touches, BlocksDoNotChangeABlow) {
  const Map map = map_of(bar_bank(8));
  const auto play = [&](std::size_t block) {
    Player player;
    player.install(0, map);
    player.push(touch_at(137, 0, kBarEnd, mallet_with(0.7, 0.02, 3e7, 0.8)));
    player.push(strike_at(150, 0, {0, 0, 0.01}, 0, {0.05, 0, 0}));
    player.render(9600, block);
    return player.left;
  };
  const Samples once = play(256);
  for (const std::size_t block : {1u, 37u, 64u, 255u}) EXPECT_LT(off_by_db(once, play(block)), -100) << block;
}

// The speed of the bow is the surface's where it sticks: a mode bowed hard enough swings at no less.
TEST(Touches, ABowedModeSoundsAtItsPitchUntilTheBowIsLifted) {
  const double pitch = 220, kg = 0.05;
  const Map map = map_of(single_mode_bank(pitch, 3, {0, 0, static_cast<float>(1 / std::sqrt(kg))}));
  Player player;
  player.install(0, map);
  player.push(touch_at(0, 0, {1, 1, 1}, bow_with(0.2, 1)));
  player.push(touch_at(96000, 0, {1, 1, 1}, bow_with(0.2, 0)));
  player.render(3 * 48000);
  const auto late = player.left_from(48000).first(48000);
  double peak = 0;
  std::vector<double> crossings;
  for (std::size_t n = 1; n < late.size(); ++n) {
    peak = std::max(peak, std::abs(late[n]));
    if (late[n - 1] < 0 && late[n] >= 0)
      crossings.push_back(static_cast<double>(n) - late[n] / (late[n] - late[n - 1]));
  }
  const double measured = kRate * static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  EXPECT_LT(std::abs(1200 * std::log2(measured / pitch)), 2);
  const double omega = 2 * std::numbers::pi * pitch, unit = std::numbers::sqrt2 / 2 * kLoudness * omega;
  EXPECT_GT(peak, 0.9 * unit * 0.2 * std::sqrt(kg));
  EXPECT_LT(peak, 3 * unit * 0.2 * std::sqrt(kg));
  // Lifted, it decays as it would.
  const auto level = [&](std::size_t from) {
    double sum = 0;
    for (const double x : player.left_from(from).first(4800)) sum += x * x;
    return std::sqrt(sum);
  };
  EXPECT_NEAR(std::log(level(100000) / level(124000)) / 0.5, 3, 0.1);
  RecordProperty("cents", std::to_string(1200 * std::log2(measured / pitch)));
}

TEST(Touches, WhatIsStruckShakesWhatItTouches) {
  const Map bar = map_of(bar_bank(8)), other = map_of(random_bank(4, 50, 40));
  Player player;
  player.install(0, bar);
  player.install(1, other);
  Touch couple{.kind = Touch::Kind::couple, .direction = kUpward, .friction = 0.3, .stiffness = 1e8, .bounce = 0.8};
  couple.gap_m = 2e-6;
  couple.other_point_m = {1, 0, 0};
  couple.other = 1;
  ASSERT_TRUE(player.mixer.silence(0, true));
  player.push(touch_at(0, 0, kBarEnd, couple));
  player.push(strike_at(4800, 0, {0, 0, -0.02}, 0, {0, 0, 0}));
  player.render(24000);
  EXPECT_EQ(*std::ranges::max_element(std::span(player.left).first(4800)), 0);
  EXPECT_GT(*std::ranges::max_element(player.left), 1e-3);
  for (const double sample : player.left) ASSERT_TRUE(std::isfinite(sample));
  EXPECT_EQ(player.mixer.counters().not_finite, 0u);
}

TEST(Touches, WhatLiesByItsWeightComesToRest) {
  const Map bar = map_of(bar_bank(8)), other = map_of(random_bank(4, 50, 40));
  Player player;
  player.install(0, bar);
  player.install(1, other);
  Touch couple{.kind = Touch::Kind::couple,
               .direction = kUpward,
               .force_n = 2,
               .mass_kg = 0.2,
               .friction = 0.3,
               .stiffness = 1e8,
               .bounce = 0.5};
  couple.gap_m = 1e-3;
  couple.other_point_m = {1, 0, 0};
  couple.other = 1;
  player.push(touch_at(0, 0, kBarEnd, couple));
  player.render(6 * 48000);
  const auto level = [&](std::size_t from) {
    double sum = 0;
    for (const double x : player.left_from(from).first(4800)) sum += x * x;
    return std::sqrt(sum);
  };
  EXPECT_GT(level(2400), 1e-4);
  EXPECT_LT(level(5 * 48000), 0.05 * level(2400));
}

// Eight alike that touch an object in one place move alike, but for the order in which their laws are made straight:
// each of the 24 directions is felt by all.
TEST(Touches, WhatTouchesLastIsFeltLikeWhatTouchesFirst) {
  const Map bar = map_of(bar_bank(8)), other = map_of(random_bank(4, 50, 40));
  const auto heard = [&](ObjectNumber number) {
    Player player;
    player.install(0, bar);
    for (ObjectNumber n = 1; n <= 8; ++n) player.install(n, other);
    for (ObjectNumber n = 0; n <= 8; ++n) EXPECT_TRUE(player.mixer.silence(n, n != number));
    Touch couple{.kind = Touch::Kind::couple, .direction = kUpward, .friction = 0.3, .stiffness = 1e8, .bounce = 0.8};
    couple.gap_m = -1e-6;
    couple.other_point_m = {1, 0, 0};
    for (ObjectNumber n = 1; n <= 8; ++n) {
      couple.other = n;
      couple.number = n;
      player.push(touch_at(0, 0, kBarEnd, couple));
    }
    player.push(strike_at(480, 0, {0, 0, -0.02}, 0, {0, 0, 0}));
    player.render(9600);
    EXPECT_EQ(player.mixer.counters().refused, 0u);
    return Samples(player.left.begin(), player.left.end());
  };
  const Samples first = heard(1), last = heard(8);
  EXPECT_GT(*std::ranges::max_element(first), 1e-4);
  EXPECT_LT(off_by_db(first, last), -40);
}

// More mallets than there are places for: the others strike one-way, and none is lost.
TEST(Touches, MalletsBeyondTheLastPlaceStrikeOneWay) {
  const Map map = map_of(bar_bank(8));
  const auto loudest = [&](std::size_t at_once) {
    Player player;
    for (ObjectNumber object = 0; object < 24; ++object) player.install(object, map);
    for (ObjectNumber object = 0; object < at_once; ++object) {
      player.push(touch_at(10, object, kBarEnd, mallet_with(0.5, 0.01, 1e7)));
    }
    player.render(9600);
    EXPECT_EQ(player.mixer.counters().refused, 0u);
    double sum = 0;
    for (const double x : player.left) sum += x * x;
    return std::sqrt(sum) / static_cast<double>(at_once);
  };
  EXPECT_NEAR(loudest(24) / loudest(8), 1, 0.25);  // a stand-in hits once, where a mallet may chatter
}

// The second mallet may come in the chunk after the one in which the first has left, and takes its place then.
TEST(Touches, AnObjectRingsOnWhileTheNextMalletHitsAnother) {
  const Map map = map_of(bar_bank(8));
  const auto heard = [&](bool first, std::optional<Frame> second) {
    Player player;
    for (ObjectNumber object = 0; object < 2; ++object) player.install(object, map);
    if (first) player.push(touch_at(10, 0, kBarEnd, mallet_with(0.5, 0.01, 1e7)));
    if (second) player.push(touch_at(*second, 1, kBarEnd, mallet_with(0.5, 0.01, 1e7)));
    player.render(4800);
    return Samples(player.left.begin(), player.left.end());
  };
  const Samples alone = heard(true, {});
  for (Frame second = 10; second < 1500; second += kChunkFrames) {
    Samples sum = heard(false, second);
    std::ranges::transform(sum, alone, sum.begin(), std::plus());
    EXPECT_LT(off_by_db(sum, heard(true, second)), -100) << second;
  }
}

// A key that is released and struck again at once sends a clear and a mallet within one chunk.
TEST(Touches, AMalletThatComesAfterAClearIsNotEndedByIt) {
  const Map map = map_of(bar_bank(8));
  const auto heard = [&](bool cleared, Frame hit) {
    Player player;
    player.install(0, map);
    if (cleared) player.push(clear_at(10, 0));
    player.push(touch_at(hit, 0, kBarEnd, mallet_with(0.5, 0.01, 1e7)));
    player.render(4800);
    return Samples(player.left.begin(), player.left.end());
  };
  for (const Frame hit : {10, 50}) EXPECT_LT(off_by_db(heard(false, hit), heard(true, hit)), -100) << hit;
}

TEST(Touches, TakeNoMemoryAndNoLocks) {
  const Map map = map_of(random_bank(3, 100, 60));
  Player player;
  for (ObjectNumber object = 0; object < 3; ++object) player.install(object, map);
  std::vector<float> left(256), right(256);
  player.push(touch_at(0, 0, {1, 0, 0}, bow_with(0.3, 2)));
  Touch couple{.kind = Touch::Kind::couple, .direction = kUpward, .friction = 0.3, .stiffness = 1e8};
  couple.other_point_m = {1, 0, 0};
  couple.other = 1;
  player.push(touch_at(100, 0, {1, 0, 0}, couple));
  couple.other = 2;
  player.push(touch_at(120, 1, {0, 1, 0}, couple));
  player.push(touch_at(400, 2, {0, 1, 0}, mallet_with(2, 0.02, 1e9)));
  player.push(clear_at(6000, 1));
  const RealtimeScope scope;
  for (int block = 0; block < 60; ++block) player.mixer.render(left, right);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

}  // namespace
}  // namespace ringdown::synth::test
