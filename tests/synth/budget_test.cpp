// The time budget: what is left out when time is short, that blocks keep to their time, and that all comes back.
#include "engine/synth/budget.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <cmath>
#include <cstdio>
#include <utility>

namespace ringdown::synth::test {
namespace {

// Time that passes only by work.
std::int64_t fake_now_ns = 0;
double fake_unit_ns = 0;
std::int64_t fake_clock() RINGDOWN_REALTIME { return fake_now_ns; }
void fake_work(double units) RINGDOWN_REALTIME { fake_now_ns += static_cast<std::int64_t>(units * fake_unit_ns); }
constexpr Budget::Clock kFake{fake_clock, fake_work};

constexpr std::int64_t kBlock_ns = 1'000'000;  // of 100 frames at 100 kHz

TEST(Budget, LearnsWhatWorkCostsAndSharesABlockAmongItsChunks) {
  Budget budget;
  fake_unit_ns = 10;
  budget.set_clock(kFake);
  budget.set_share(0.5);
  for (int block = 0; block < 200; ++block) {
    budget.open_block(100, 1e5, true);
    for (int chunk = 0; chunk < 4; ++chunk) {
      budget.open_chunk(25);
      budget.worked(10000);
      budget.close_chunk(10000);
    }
  }
  budget.open_block(100, 1e5, true);
  budget.open_chunk(25);
  EXPECT_NEAR(budget.affordable(), 0.5 * kBlock_ns / 4 / 10, 50);
  EXPECT_FALSE(budget.over(12000));
  EXPECT_TRUE(budget.over(13000));
  fake_now_ns += kBlock_ns / 8 + 1;
  EXPECT_TRUE(budget.over(0));
  budget.open_chunk(25);
  EXPECT_FALSE(budget.over(0)) << "the other chunks share what is left";
  EXPECT_NEAR(budget.affordable(), 0.5 * kBlock_ns / 4 / 10, 50);
}

TEST(Budget, BlocksWithoutALimitOrADeadlineAreNeverOver) {
  for (const double share : {0.0, 0.5}) {
    Budget budget;
    budget.set_clock(kFake);
    budget.set_share(share);
    budget.open_block(100, 1e5, share == 0);
    budget.open_chunk(100);
    fake_now_ns += 1000 * kBlock_ns;
    EXPECT_FALSE(budget.limited());
    EXPECT_FALSE(budget.over(0));
  }
}

TEST(Budget, ReadsItsClockWithoutASystemCall) {
  const RealtimeScope scope;
  EXPECT_GT(Budget::now_ns(), 0);
  EXPECT_EQ(scope.seen().total(), 0u) << scope.seen().first;
}

constexpr std::size_t kFrames = 128;
constexpr double kPeriod_ns = kFrames * 1e9 / kRate;
constexpr ObjectNumber kObjects = 80;
constexpr std::size_t kModes = 500;

// Objects of many modes, each struck 1 dB more softly than the one before, and what a block of them costs.
class Scene {
 public:
  explicit Scene(double share, bool keep_deadlines = true) {
    mixer().set_clock(kFake);
    mixer().keep_deadlines(keep_deadlines);
    for (ObjectNumber object = 0; object < kObjects; ++object) {
      player.install(object, map_of(random_bank(object, kModes, 10)));
      player.push(strike_at(0, object, impulse(object)));
    }
    player.render(kFrames, kFrames);
    mixer().set_budget(share);
  }
  static Vec3 impulse(ObjectNumber object) { return {0, 0.03 * std::pow(10.0, -0.05 * object), 0}; }
  Mixer& mixer() { return player.mixer; }
  [[nodiscard]] std::uint32_t hidden() { return mixer().counters().hidden_modes.load(); }
  [[nodiscard]] std::uint64_t shed() { return mixer().counters().shed.load(); }

  // A unit of work takes so long that all modes, sounding, take `load` of a block.
  void set_load(double load) { unit_ns_ = load * kPeriod_ns / (kObjects * kModes); }

  // The share of its time that a block takes.
  double render() {
    fake_unit_ns = unit_ns_;
    const std::int64_t begin = fake_now_ns;
    player.render(kFrames, kFrames);
    return static_cast<double>(fake_now_ns - begin) / kPeriod_ns;
  }
  void render_blocks(int count) {
    for (int i = 0; i < count; ++i) render();
  }

  Player player;

 private:
  double unit_ns_ = 0;
};

TEST(Shedding, ABudgetThatIsNotUsedUpChangesNothing) {
  Scene with(0.8), without(0);
  for (Scene* scene : {&with, &without}) {
    scene->set_load(0.6);
    scene->render_blocks(20);
    for (ObjectNumber object = 0; object < 8; ++object) {
      scene->player.push(strike_at(21 * 128 + 3000 * object, object, Scene::impulse(object)));
    }
    scene->render_blocks(300);
  }
  EXPECT_EQ(with.player.left, without.player.left);
}

TEST(Shedding, FourTimesTooMuchIsDoneInTime) {
  constexpr int kBlocks = 600;
  int missed[2] = {0, 0};
  double worst = 0;
  Samples sound[2];
  std::uint64_t shed = 0;
  for (const bool bounded : {false, true}) {
    Scene scene(bounded ? 0.8 : 0);
    scene.set_load(4);
    for (int block = 0; block < kBlocks; ++block) {
      if (block % 50 == 48 && block < 500) {  // a storm, all in one block
        for (ObjectNumber object = 0; object < 20; ++object) {
          scene.player.push(strike_at((block + 2) * 128 + object, object, Scene::impulse(object)));
        }
      }
      const double took = scene.render();
      missed[bounded ? 1 : 0] += took > 1 ? 1 : 0;
      if (bounded) worst = std::max(worst, took);
    }
    EXPECT_EQ(scene.mixer().counters().not_finite.load(), 0u);
    EXPECT_EQ(scene.mixer().counters().strikes.load(), kObjects + 20 * 10u) << "none is lost";
    sound[bounded ? 1 : 0] = scene.player.left;
    if (bounded) shed = scene.shed();
  }
  const double error_db = relative_error_db(std::span(sound[1]).subspan(6000), std::span(sound[0]).subspan(6000));
  std::printf(
      "deadlines missed: %d of %d unbounded, %d bounded (worst block %.2f of its time, %d chunks shed); strikes of "
      "storms are late, so the difference is %.1f dB\n",
      missed[0], kBlocks, missed[1], worst, static_cast<int>(shed), error_db);
  EXPECT_GT(missed[0], kBlocks * 9 / 10);
  EXPECT_EQ(missed[1], 0);
}

// From one moment to the next, all of it sounding.
TEST(Shedding, AMachineThatBecomesSlowCostsNoDeadline) {
  Scene scene(0.8), whole(0);
  for (Scene* each : {&scene, &whole}) {
    each->set_load(0.6);
    each->render_blocks(100);
  }
  ASSERT_EQ(scene.shed(), 0u);
  scene.set_load(2.4);
  double worst = 0;
  int missed = 0;
  for (int block = 0; block < 300; ++block) {
    const double took = scene.render();
    if (block > 0) missed += took > 1 ? 1 : 0, worst = std::max(worst, took);
  }
  whole.render_blocks(300);
  const std::size_t settled = 150 * kFrames;
  const double error_db =
      relative_error_db(std::span(scene.player.left).subspan(settled), std::span(whole.player.left).subspan(settled));
  std::printf("worst block %.2f of its time, %u modes hidden, %.1f dB missing\n", worst, scene.hidden(), error_db);
  EXPECT_EQ(missed, 0);
  EXPECT_GT(scene.hidden(), 1000u);
  EXPECT_LT(error_db, -25) << "what is loud sounds on";
}

TEST(Shedding, AllComesBackWhenThereIsTimeAndAsItWouldHaveBeen) {
  Scene scene(0.8), whole(0);
  for (Scene* each : {&scene, &whole}) {
    each->mixer().set_floor(160);
    each->set_load(0.6);
    each->render_blocks(50);
  }
  scene.set_load(2.4);
  scene.render_blocks(100);
  EXPECT_GT(scene.hidden(), 1000u);
  scene.set_load(0.3);
  int blocks = 0;
  std::uint64_t shed = 0;
  for (; (std::exchange(shed, scene.shed()) != scene.shed() || scene.hidden() > 0) && blocks < 5000; ++blocks) {
    scene.render();
  }
  EXPECT_EQ(scene.hidden(), 0u);
  scene.render_blocks(100);
  EXPECT_EQ(scene.shed(), shed) << "nothing more is shed";
  whole.set_load(0.3);
  whole.render_blocks(200 + blocks);
  const std::size_t back = scene.player.left.size() - 100 * kFrames;
  const double error_db =
      relative_error_db(std::span(scene.player.left).subspan(back), std::span(whole.player.left).subspan(back));
  std::printf("all is back after %.1f s, and differs by %.0f dB\n", blocks * kFrames / kRate, error_db);
  EXPECT_LT(error_db, -100);
}

// What was shed comes back by 3 dB in 4096 frames; an object is 1 dB quieter than the one before.
TEST(Shedding, DoesNotPump) {
  Scene scene(0.8);
  scene.set_load(0.6);
  scene.render_blocks(50);
  scene.set_load(2.4);
  scene.render_blocks(200);
  std::uint32_t before = scene.hidden();
  double moved = 0;
  for (int block = 0; block < 375; ++block) {
    scene.render();
    moved += std::abs(static_cast<double>(scene.hidden()) - before);
    before = scene.hidden();
  }
  std::printf("in a second under steady load %.0f of %zu modes come or go\n", moved, kObjects * kModes);
  EXPECT_LT(moved, 0.5 * kObjects * kModes);
  scene.set_load(0.3);
  for (int second = 0; second < 3; ++second) {
    const std::uint32_t was = scene.hidden();
    scene.render_blocks(static_cast<int>(4096 / kFrames));
    EXPECT_LT(static_cast<double>(was) - scene.hidden(), 0.2 * kObjects * kModes);
  }
}

TEST(Shedding, WhatHasNoDeadlineIsNeverShed) {
  Scene with(0.8, false), without(0);
  for (Scene* scene : {&with, &without}) {
    scene->set_load(4);
    scene->render_blocks(100);
  }
  EXPECT_EQ(with.player.left, without.player.left);
  EXPECT_EQ(with.shed(), 0u);
}

TEST(Shedding, EndsWithTheBudget) {
  Scene scene(0.8);
  scene.set_load(4);
  scene.render_blocks(100);
  EXPECT_GT(scene.hidden(), 0u);
  scene.mixer().set_budget(0);
  scene.render_blocks(2);
  EXPECT_EQ(scene.hidden(), 0u);
}

// Objects that share their states: they are shed in their sums.
TEST(Shedding, FamiliesKeepToTheTimeToo) {
  GTEST_SKIP() << "under a budget a strike on objects that share states may be played twice: not mended yet";
  int missed[2] = {0, 0};
  Samples sound[2];
  for (const bool bounded : {false, true}) {
    Player player;
    player.mixer.set_clock(kFake);
    std::vector<std::shared_ptr<ModeTable>> tables;
    for (std::uint32_t kind = 0; kind < 20; ++kind) {
      tables.push_back(std::make_shared<ModeTable>(map_of(random_bank(kind, 500, 10)), modal::MaterialScale{}, kRate));
    }
    for (ObjectNumber object = 0; object < 60; ++object) {
      ASSERT_TRUE(player.mixer.install(object, std::make_unique<Voice>(tables[object % 20]), Mixer::Install::replace));
    }
    for (ObjectNumber object = 0; object < 60; ++object) player.push(strike_at(0, object, Scene::impulse(object % 20)));
    fake_unit_ns = 0;
    player.render(kFrames, kFrames);
    player.mixer.set_budget(bounded ? 0.8 : 0);
    fake_unit_ns = 4 * kPeriod_ns / (20 * 500 * 2);
    for (int block = 0; block < 400; ++block) {
      for (ObjectNumber object = 0; object < 10 && block % 40 == 5; ++object) {
        player.push(strike_at((block + 1) * 128 + object, object, Scene::impulse(object % 20)));
      }
      if (block % 40 == 20) player.push(gain_at((block + 1) * 128, static_cast<ObjectNumber>(block / 40), 0.5, 0.01));
      const std::int64_t begin = fake_now_ns;
      player.render(kFrames, kFrames);
      const bool late = static_cast<double>(fake_now_ns - begin) > kPeriod_ns;
      missed[bounded ? 1 : 0] += late && block > 0 ? 1 : 0;  // in the first it learns what work costs
    }
    if (bounded) {
      fake_unit_ns /= 100;
      for (int block = 0; block < 2000; ++block) player.render(kFrames, kFrames);
      EXPECT_EQ(player.mixer.counters().hidden_modes.load(), 0u);
    } else {
      for (int block = 0; block < 2000; ++block) player.render(kFrames, kFrames);
    }
    EXPECT_EQ(player.mixer.counters().strikes.load(), 160u);
    EXPECT_EQ(player.mixer.counters().not_finite.load(), 0u);
    sound[bounded ? 1 : 0] = player.left;
  }
  std::printf("deadlines missed: %d of 400 unbounded, %d bounded\n", missed[0], missed[1]);
  EXPECT_GT(missed[0], 300);
  EXPECT_EQ(missed[1], 0);
}

TEST(Shedding, IsRealTimeSafe) {
  Scene scene(0.8);
  scene.set_load(4);
  scene.render_blocks(2);
  std::vector<float> left(kFrames), right(kFrames);
  for (int block = 2; block < 200; ++block) {
    if (block == 100) scene.set_load(0.2);
    scene.player.push(strike_at(block * 128 + 5, static_cast<ObjectNumber>(block % kObjects), {0.01, 0, 0}));
    const RealtimeScope scope;
    scene.mixer().render(left, right);
    ASSERT_EQ(scope.seen().total(), 0u) << scope.seen().first;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
