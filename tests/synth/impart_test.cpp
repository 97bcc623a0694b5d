// One mode set going by a motion that is known, against strikes and against a body that rings on.
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ringdown::synth::test {
namespace {

constexpr Frame kLater = 5003;  // neither a chunk's nor a block's beginning

// The motion that a strike on vertex 0 of the bank leaves, `frames` after it.
std::vector<verb::Impart> motion_after(const modal::Bank& bank, Vec3 impulse_ns, Frame frames) {
  std::vector<std::size_t> by_frequency(bank.mode_count());
  std::iota(by_frequency.begin(), by_frequency.end(), 0);
  std::ranges::sort(by_frequency, {}, [&bank](std::size_t m) { return bank.frequency_hz[m]; });
  std::vector<verb::Impart> motion;
  const double time_s = static_cast<double>(frames) / kRate;
  for (std::uint32_t rank = 0; rank < by_frequency.size(); ++rank) {
    const std::size_t m = by_frequency[rank];
    const modal::Vec3f shape = bank.shape(m, 0);
    const double velocity = shape[0] * impulse_ns.x + shape[1] * impulse_ns.y + shape[2] * impulse_ns.z;
    const double omega = 2 * std::numbers::pi * bank.frequency_hz[m];
    motion.push_back({rank, velocity * std::exp(-bank.decay_per_s[m] * time_s), std::fmod(omega * time_s, 2 * M_PI)});
  }
  return motion;
}

// A body that rings on, and one that takes over its motion at kLater, must be alike from there on.
void expect_taken_over(const modal::Bank& bank, const std::vector<Frame>& others) {
  const Vec3 impulse_ns{0.3, -0.2, 1};
  Player player, taker;
  player.install(0, map_of(bank));
  taker.install(0, map_of(bank));
  player.push(vertex_strike_at(0, 0, 0, impulse_ns));
  for (const verb::Impart& impart : motion_after(bank, impulse_ns, kLater)) taker.push({kLater, 0, impart});
  for (const Frame frame : others) {
    player.push(vertex_strike_at(frame, 0, 0, {0, 0, 1}));
    taker.push(vertex_strike_at(frame, 0, 0, {0, 0, 1}));
  }
  player.render(12000);
  taker.render(12000);
  EXPECT_EQ(peak(std::span(taker.left).first(kLater)), 0);
  EXPECT_LT(relative_error_db(taker.left_from(kLater), player.left_from(kLater)), -110);
}

TEST(Impart, AMotionThatIsTakenOverSoundsOn) {
  expect_taken_over(single_mode_bank(440, 4), {});
  expect_taken_over(bar_bank(8), {});
}

TEST(Impart, AMotionThatIsTakenOverSoundsOnByMoments) {
  expect_taken_over(random_bank(3, 200, 40), {});
  expect_taken_over(random_bank(3, 200, 40), {kLater + 20, kLater + 900});
}

TEST(Impart, AMotionFromRestIsAStrike) {
  const modal::Bank bank = random_bank(4, 60, 40);
  Player struck, moved;
  struck.install(0, map_of(bank));
  moved.install(0, map_of(bank));
  struck.push(vertex_strike_at(100, 0, 0, {0, 1, 0}));
  for (const verb::Impart& impart : motion_after(bank, {0, 1, 0}, 0)) moved.push({100, 0, impart});
  struck.render(4000);
  moved.render(4000);
  EXPECT_LT(relative_error_db(moved.left, struck.left), -130);
}

TEST(Impart, MembersOfAnInstanceGroupTakeMotionsOverAlike) {
  const Map map = map_of(random_bank(5, 100, 40));
  const auto voice = voice_of(map);
  Player group, alone;
  for (ObjectNumber object = 0; object < 3; ++object)
    ASSERT_TRUE(group.mixer.install(object, std::make_unique<Voice>(voice->shared_table()), Mixer::Install::replace));
  alone.install(1, map);
  for (const verb::Impart& impart : motion_after(map->bank(), {1, 0, 1}, kLater)) {
    group.push({777, 1, impart});
    alone.push({777, 1, impart});
  }
  group.render(8000);
  alone.render(8000);
  EXPECT_LT(relative_error_db(group.left, alone.left), -110);
  EXPECT_GT(peak(alone.left), 0);
}

TEST(Impart, AModeThatIsNotThereIsCounted) {
  Player player;
  player.install(0, map_of(bar_bank(3)));
  player.push({0, 0, verb::Impart{3, 1, 0}});
  player.push({0, 0, verb::Impart{0, NAN, 0}});
  player.render(1000);
  EXPECT_EQ(player.mixer.counters().refused, 2u);
  EXPECT_EQ(peak(player.left), 0);
}

// As fast as a body breaks: the sound ends within a quarter of a millisecond.
TEST(Choke, AChokeOfNoTimeEndsTheSoundAtOnce) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 4)));
  player.push(strike_at(0, 0, {0, 0, 1}));
  player.push({5000, 0, verb::Choke{0}});
  player.render(6000);
  EXPECT_GT(peak(std::span(player.left).subspan(4800, 200)), 0);
  EXPECT_EQ(peak(player.left_from(5000 + 13)), 0);
}

}  // namespace
}  // namespace ringdown::synth::test
