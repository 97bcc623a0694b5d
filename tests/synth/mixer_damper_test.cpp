// A hand on an object: modes die by how much they move there, without a click, and go on when it is taken away.
#include "engine/modal/added_decay.h"

#include "tests/synth/player.h"

namespace ringdown::synth::test {
namespace {

using modal::Damper;

std::unique_ptr<Voice> damped_voice(const Map& map, const Damper& damper) {
  return std::make_unique<Voice>(
      std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate, modal::Dampers{{0, damper}}));
}

double decay_of(const Map& map, const Damper& damper) {
  Player player;
  EXPECT_TRUE(player.mixer.install(0, damped_voice(map, damper), Mixer::Install::replace));
  player.push(vertex_strike_at(0, 0, 0, {0.01, 0.01, 0.01}));
  player.render(24000);
  return fit_damped_sinusoid(player.left_from(2400), kRate).decay_per_s;
}

TEST(Touch, ADamperAddsHalfItsDampingTimesTheShapeSquaredToTheDecay) {
  const Map map = map_of(single_mode_bank(440, 2, {0.3f, 0, 0.4f}));
  EXPECT_NEAR(decay_of(map, {}), 2, 0.02);
  EXPECT_NEAR(decay_of(map, {{1, 1, 1}, {}, 200}), 2 + 0.5 * 200 * 0.25, 0.3);
  EXPECT_NEAR(decay_of(map, {{1, 1, 1}, {2, 0, 0}, 200}), 2 + 0.5 * 200 * 0.09, 0.2);
  EXPECT_NEAR(decay_of(map, {{1, 1, 1}, {0, 0, -1}, 200}), 2 + 0.5 * 200 * 0.16, 0.2);
  EXPECT_NEAR(decay_of(map, {{1, 1, 1}, {0, 5, 0}, 200}), 2, 0.02) << "it does not move along y";
  EXPECT_NEAR(decay_of(map, {{1, 1, 1}, {0.4, 0, -0.3}, 200}), 2, 0.02) << "nor across its own motion";
}

TEST(Touch, ADamperSparesModesThatHaveANodeUnderIt) {
  modal::Bank bank = bar_bank(2);
  const Map map = map_of(bank);
  const auto at = [&](double x) { return modal::added_decay(*map, {{0, {{x * 0.3, 0, 0}, {}, 1}}}); };
  EXPECT_LT(at(0.5)[1], 1e-3 * at(0)[1]) << "the second mode is antisymmetric";
  EXPECT_GT(at(0.5)[0], 0.1 * at(0)[0]);
}

TEST(Touch, ADamperIsLaidOnAndTakenAwayWithoutAClick) {
  const Map map = map_of(random_bank(4, 40, 20));
  Player player;
  player.install(0, map);
  player.push(vertex_strike_at(0, 0, 3, {0.01, 0, 0}));
  player.render(4800);
  for (const double damping : {50.0, 0.0, 1e6, 0.0}) {
    const std::size_t now = player.left.size();
    ASSERT_TRUE(player.mixer.install(0, damped_voice(map, {{1, 0, 0}, {}, damping}), Mixer::Install::retune));
    player.render(4800);
    player.mixer.collect();
    EXPECT_LE(largest_step(player.left, now, now + 480), 1.02 * largest_step(player.left, now - 2400, now)) << damping;
  }
}

TEST(Touch, ADamperIsLaidOnAtItsFrameAtEveryBlockSize) {
  const Map map = map_of(random_bank(4, 40, 20));
  const auto play = [&](Frame at, std::size_t block) {
    Player player;
    player.install(0, map);
    player.push(vertex_strike_at(0, 0, 3, {0.01, 0, 0}));
    EXPECT_TRUE(player.mixer.install(0, damped_voice(map, {{1, 0, 0}, {}, 50}), Mixer::Install::retune, at));
    player.render(6000, block);
    return player.left;
  };
  const Samples never = play(1 << 20, 256), first = play(1777, 256);
  const auto [a, b] = std::ranges::mismatch(never, first);
  EXPECT_NEAR(static_cast<double>(a - never.begin()), 1778, 1);
  for (const std::size_t block : {1, 64, 1777, 6000}) {
    EXPECT_LT(relative_error_db(play(1777, block), first), -110) << block;
  }
}

// The sum of |z|^2 falls whatever is laid on: seen in a single mode, whose envelope is its energy.
TEST(Touch, ADamperNeverMakesAnObjectLouder) {
  const Map map = map_of(single_mode_bank(440, 0.5));
  Player player;
  player.install(0, map);
  player.push(vertex_strike_at(0, 0, 0, {0.01, 0.01, 0.01}));
  player.render(4800);
  double before = 1e9;
  for (int i = 0; i < 40; ++i) {
    const double damping = i % 2 == 0 ? 3.0 * i : 0.0;
    ASSERT_TRUE(player.mixer.install(0, damped_voice(map, {{1, 1, 1}, {}, damping}), Mixer::Install::retune));
    const std::size_t now = player.left.size();
    player.render(2400);
    player.mixer.collect();
    const double loudest = peak(player.left_from(now));
    EXPECT_LE(loudest, before * 1.0001);
    before = loudest;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
