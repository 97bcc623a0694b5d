// Sound that takes its time to the listener, and the pitch of what passes by, against closed forms.
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace ringdown::synth::test {
namespace {

constexpr double kSpeedOfSound = 343.2;  // of dry air at 20 degrees, as the mixer has it
constexpr double kTone_hz = 880, kDecay = 0.001;

Event listener_here() { return {.verb = verb::Listener{}}; }
Event pose_at(Frame frame, Vec3 position_m) { return {.frame = frame, .verb = verb::Pose{{position_m, {}}}}; }

class TravelTime : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    set(player_.mixer, &MixerSettings::travel_time, GetParam());
    player_.install(0, map_of(single_mode_bank(kTone_hz, kDecay)));
    player_.push(listener_here());
  }

  // Renders while poses come 60 times a second, 50 ms ahead of their time.
  void fly(const std::function<Vec3(double)>& path, std::size_t frames) {
    for (std::size_t block = 0, poses = 0; block < frames; block += 240) {
      while (static_cast<double>(poses) / 60 < static_cast<double>(block) / kRate + 0.05) {
        const double t = static_cast<double>(poses++) / 60;
        player_.push(pose_at(std::llround(t * kRate), path(t)));
      }
      player_.render(240, 240);
    }
  }

  Player player_;
};

TEST_P(TravelTime, WhatStandsIsHeardWhenItsSoundHasArrivedOrAtOnce) {
  player_.push(pose_at(0, {0, 60, 80}));  // 100 m away
  player_.push(vertex_strike_at(1000, 0, 0, {0, 0, 1}));
  player_.push(clear_at(24000, 0));
  player_.render(48000, 255);
  const auto heard = static_cast<Frame>(std::ranges::find_if(player_.left, [](double sample) { return sample != 0; }) -
                                        player_.left.begin());
  const double way = GetParam() ? 100 / kSpeedOfSound * kRate : 0;
  EXPECT_NEAR(static_cast<double>(heard), 1000 + way, 2);
  const auto at = [&](double frame) { return std::abs(player_.left[static_cast<std::size_t>(frame)]); };
  double before = 0, after = 0;
  for (int i = 0; i < 100; ++i) {
    before = std::max(before, at(24000 + way - 200 + i));
    after = std::max(after, at(24000 + way + 2000 + i));
  }
  EXPECT_GT(before, 0);
  EXPECT_LT(after, 1e-6 * before) << "the fade-out travels, too";
}

// What is heard at t left the source at the time e with e + |place(e)| / c = t.
TEST_P(TravelTime, APassingToneHasThePitchAndTheLevelOfTheClosedForm) {
  const double speed = 60, aside = 5, begin = -40;
  const auto place = [&](double t) { return Vec3{begin + speed * t, aside, 0}; };
  player_.push(vertex_strike_at(7000, 0, 0, {0, 0, 1}));  // the track has not been looked at for long
  fly(place, 62400);
  const bool travels = GetParam();
  const auto left_at = [&](double t) {
    double e = t;
    for (int i = 0; travels && i < 60; ++i) e = t - length(place(e)) / kSpeedOfSound;
    return e;
  };
  // d e / d t in closed form: with travel 1 / (1 + r'), where r' = d|place| / dt over c at e; without, the same of now.
  const auto rate_at = [&](double t) {
    const double e = left_at(t);
    return 1 / (1 + speed * place(e).x / length(place(e)) / kSpeedOfSound);
  };
  // Pitch by zero crossings, each found between two samples by a straight line, over 8 of them.
  std::vector<double> crossings;
  const auto mono = [&](std::size_t n) { return player_.left[n] + player_.right[n]; };
  const double struck_s = 7000 / kRate;
  const double from_s = struck_s + (travels ? length(place(struck_s)) / kSpeedOfSound : 0) + 0.01;
  for (auto n = static_cast<std::size_t>(from_s * kRate); n + 1 < player_.left.size(); ++n) {
    if (mono(n) < 0 && mono(n + 1) >= 0) {
      crossings.push_back((static_cast<double>(n) - mono(n) / (mono(n + 1) - mono(n))) / kRate);
    }
  }
  ASSERT_GT(crossings.size(), 700u);
  constexpr std::size_t kPeriods = 8;
  double worst = 0;
  for (std::size_t i = 0; i + kPeriods < crossings.size(); ++i) {
    const double a = crossings[i], b = crossings[i + kPeriods];
    const double heard_hz = kPeriods / (b - a);
    double mean = 0;  // Simpson's rule over the interval
    constexpr int kParts = 16;
    for (int k = 0; k <= kParts; ++k) {
      const double weight = (k == 0 || k == kParts ? 1 : k % 2 == 1 ? 4 : 2) / (3.0 * kParts);
      mean += weight * rate_at(a + (b - a) * k / kParts);
    }
    worst = std::max(worst, std::abs(1200 * std::log2(heard_hz / (kTone_hz * mean))));
  }
  EXPECT_LT(worst, 1) << "cents";

  // Where it is loudest: when the sound from the nearest point arrives, 5 m away.
  std::size_t loudest = 0;
  for (std::size_t n = 0; n < player_.left.size(); ++n) {
    if (std::hypot(player_.left[n], player_.right[n]) > std::hypot(player_.left[loudest], player_.right[loudest])) {
      loudest = n;
    }
  }
  const double nearest_s = -begin / speed + (travels ? aside / kSpeedOfSound : 0);
  EXPECT_NEAR(static_cast<double>(loudest) / kRate, nearest_s, 0.003);  // crests come every 0.6 ms
}

// Poses and strikes from everywhere: nothing is lost, nothing comes twice.
TEST_P(TravelTime, EveryStrikeIsHeardOnce) {
  player_.push(pose_at(0, {3, 0, 0}));
  for (int i = 0; i < 300; ++i) {
    player_.push(vertex_strike_at(100 * i, 0, 0, {0, 0, 1e-4}));
    if (i % 10 == 0) player_.push(pose_at(100 * i, {3 + 20 * std::sin(i), 30 * std::cos(i), 0}));
    player_.render(100, 100);
  }
  player_.render(24000);
  EXPECT_EQ(player_.mixer.counters().strikes.load(), 300u);
  EXPECT_EQ(player_.mixer.counters().late.load(), 0u);
}

INSTANTIATE_TEST_SUITE_P(OnAndOff, TravelTime, testing::Bool(),
                         [](const auto& of) { return std::string(of.param ? "Travels" : "AtOnce"); });

}  // namespace
}  // namespace ringdown::synth::test
