// Objects that share their states and are heard from their places: as each of them alone.
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::synth::test::instances {
namespace {

constexpr std::size_t kObjects = 30, kModes = 40;

// Coins whose modes have lobes, and that ring for 0.1 s.
Map coin(double t60_s) {
  modal::Bank bank = random_bank(5, kModes, 30);
  for (std::size_t m = 0; m < kModes; ++m) {
    bank.decay_per_s[m] = std::log(1000.0) / t60_s;
    modal::FarField& field = bank.radiation->maps.modes[m];
    const std::complex<float> value = field.terms[0].value;
    field.terms = {{0, 0.5F * value}, {static_cast<std::uint16_t>(1 + m % 8), std::complex<float>(0.7F, 0.5F) * value}};
    field.unit = 0;
    field.levels.clear();
  }
  bank.losses.clear();
  return map_of(std::move(bank));
}

Event pose_at(Frame frame, ObjectNumber object, const Pose& pose) {
  return {.frame = frame, .object = object, .verb = verb::Pose{{pose.position_m, pose.rotation}}};
}

// The same things happen to two mixers: in one the objects share a table, in the other each has its own.
struct Both {
  Player shared, alone;

  explicit Both(const Map& map) {
    const auto table = std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate);
    for (ObjectNumber o = 0; o < kObjects; ++o) {
      const auto own = std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate);
      EXPECT_TRUE(shared.mixer.install(o, std::make_unique<Voice>(table), Mixer::Install::replace));
      EXPECT_TRUE(alone.mixer.install(o, std::make_unique<Voice>(own), Mixer::Install::replace));
    }
    push({.frame = 0, .verb = verb::Listener{{{0, -2, 0}, {}}}});
  }
  void push(const Event& event) { shared.push(event), alone.push(event); }
  // Each object turns by `spin` and is struck now and then, for a second.
  void play(double spin_rad_s) {
    const auto frame_of = [](int i) { return static_cast<Frame>(std::llround(i * kRate / 60)); };
    int told = 0;
    for (Frame now = 0; now < 24000; now += 256) {
      for (; frame_of(told) < now + 2400; ++told) {
        for (ObjectNumber o = 0; o < kObjects && (told == 0 || spin_rad_s > 0); ++o) {
          const double angle = o + spin_rad_s * told / 60;
          push(pose_at(frame_of(told), o, {{o - 15.0, 1, 0}, about({1, 0, 1}, angle)}));
        }
      }
      const auto struck = static_cast<ObjectNumber>(now / 256 % kObjects);
      push(vertex_strike_at(now + 100, struck, struck % 7, {0.02, 0.01, 0.03}));
      shared.render(256);
      alone.render(256);
    }
  }
  [[nodiscard]] double difference_db() const { return relative_error_db(shared.left, alone.left); }
  [[nodiscard]] std::uint32_t modes() const { return shared.mixer.counters().ringing_modes; }
};

TEST(HeardInstances, WhatStandsSharesItsStatesAndIsHeardAsEachAlone) {
  Both both(coin(0.3));
  both.play(0);
  EXPECT_LE(both.modes(), 3 * kModes);
  EXPECT_LT(both.difference_db(), -90);  // a strike hears the direction in single precision
}

TEST(HeardInstances, WhatTurnsLittleWhileItRingsIsHeardFromWhereItWasStruck) {
  Both both(coin(0.1));
  both.play(0.5);  // 0.02 rad in the time of 20 dB
  EXPECT_LE(both.modes(), 3 * kModes);
  EXPECT_LT(both.difference_db(), -25);
}

TEST(HeardInstances, WhatTurnsMuchRingsAloneAndIsHeardExactly) {
  Both both(coin(2));
  both.play(8);
  EXPECT_GT(both.modes(), 5 * kModes);
  EXPECT_LT(both.difference_db(), -90);
}

TEST(HeardInstances, AMoveOfTheListenerEndsWhatWasSharedWithoutALoss) {
  Both both(coin(3));
  both.play(0);
  both.push({.frame = 24576, .verb = verb::Listener{{{8, 0, 1}, {}}}});
  both.shared.render(9600);
  both.alone.render(9600);
  const auto last = [](const Player& player) { return std::span(player.left).last(4800); };
  EXPECT_LT(relative_error_db(last(both.shared), last(both.alone)), -60);
  EXPECT_EQ(both.shared.mixer.counters().not_finite, 0u);
}

TEST(HeardInstances, ObjectsStruckWhileNobodyListensGlideToTheListenerWhoReturns) {
  Both both(coin(3));
  both.play(0);
  both.push({.frame = 24576, .verb = verb::ListenerOff{}});
  for (ObjectNumber o = 0; o < kObjects; ++o) both.push(vertex_strike_at(24600, o, o % 7, {0.02, 0.01, 0.03}));
  both.shared.render(2432), both.alone.render(2432);
  const std::size_t returns = both.shared.left.size();
  both.push({.frame = static_cast<Frame>(returns), .verb = verb::Listener{{{0, -2, 0}, {}}}});
  both.shared.render(1024), both.alone.render(1024);
  EXPECT_LT(relative_error_db(both.shared.left_from(returns), both.alone.left_from(returns)), -60);
}

}  // namespace
}  // namespace ringdown::synth::test::instances
