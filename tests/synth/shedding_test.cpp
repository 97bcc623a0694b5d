// The mixer under a time budget: what is left out when time is short, that blocks keep to their time, and that all
// comes back.
#include "tests/support/realtime_guard.h"
#include "tests/synth/fake_clock.h"
#include "tests/synth/player.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr std::size_t kFrames = 128;
constexpr double kPeriod_ns = kFrames * 1e9 / kRate;
constexpr ObjectNumber kObjects = 80;
constexpr std::size_t kModes = 500;

// Objects of many modes, each struck 1 dB more softly than the one before, and what a block of them costs.
class Scene {
 public:
  explicit Scene(double share, bool keep_deadlines = true) {
    set(mixer(), &MixerSettings::clock, kFake);
    mixer().keep_deadlines(keep_deadlines);
    for (ObjectNumber object = 0; object < kObjects; ++object) {
      player.install(object, map_of(random_bank(object, kModes, 10)));
      player.push(strike_at(0, object, impulse(object)));
    }
    player.render(kFrames, kFrames);
    set(mixer(), &MixerSettings::budget, share);
  }
  static Vec3 impulse(ObjectNumber object) { return {0, 0.03 * std::pow(10.0, -0.05 * object), 0}; }
  Mixer& mixer() { return player.mixer; }
  [[nodiscard]] std::uint32_t muted() { return mixer().counters().muted_modes.load(); }
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

TEST(Shedding, FourTimesTooMuchWorkIsDoneInTime) {
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
  std::printf("worst block %.2f of its time, %u modes muted, %.1f dB missing\n", worst, scene.muted(), error_db);
  EXPECT_EQ(missed, 0);
  EXPECT_GT(scene.muted(), 1000u);
  EXPECT_LT(error_db, -25) << "what is loud sounds on";
}

// The clock is read at each object, so this is what objects cost that are only come by, as large ones do, far away in
// memory. Taken for the price of modes it would let ever fewer of them sound, in the end none.
TEST(Shedding, TheCostOfSilentObjectsDoesNotSilenceTheOthers) {
  constexpr double kShare = 0.7, kVisits = 0.35;  // of the time that may be used
  constexpr int kBlocks = 1200, kSettled = 300;
  Scene scene(kShare);
  scene.set_load(1.5);
  fake_read_ns = static_cast<std::int64_t>(kVisits * kShare * kPeriod_ns / kObjects);
  int missed = 0, silent = 0;
  double sounding = 0;
  for (int block = 0; block < kBlocks; ++block) {
    if (block % 10 == 0)
      scene.player.push(strike_at(0, static_cast<ObjectNumber>(block / 10 % kObjects), {0, 0.01, 0}));
    missed += scene.render() > 1 ? 1 : 0;
    if (block < kSettled) continue;
    const auto modes = scene.mixer().counters().ringing_modes.load();
    sounding += modes / static_cast<double>(kBlocks - kSettled);
    silent += modes == 0 ? 1 : 0;
  }
  fake_read_ns = 0;
  // Of the rest, what strikes leave of it: 500 modes at 9 units in one of ten blocks, kept in reserve.
  const double affordable = (1 - kVisits) * kShare / 1.5 * kObjects * kModes - 9.0 * kModes;
  std::printf("%.0f modes sound on average, of %.0f that there is time for\n", sounding, affordable);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(silent, 0);
  EXPECT_GT(sounding, affordable / 3);
}

// Prices of work as they may be: for each block, times what the mixer takes them for.
class Prices {
 public:
  enum class Kind { drift, jumps, noise };
  explicit Prices(Kind kind) : kind_(kind) {}
  double next() {
    const auto uniform = [this] { return 0.5 + 2.5 * static_cast<double>(random_()) / 4294967296.0; };
    if (kind_ == Kind::noise) return uniform();
    if (kind_ == Kind::jumps && random_() % 60 == 0) price_ = uniform();
    const double wobble = kind_ == Kind::drift ? 0.1 : 0.05;
    price_ *= 1 + wobble * (static_cast<double>(random_()) / 2147483648.0 - 1);
    price_ = std::clamp(price_, 0.5, 3.0);
    return price_;
  }

 private:
  Kind kind_;
  std::mt19937 random_{7};
  double price_ = 1;
};

TEST(Shedding, TheMixerUsesMostOfItsTimeAndNoMoreWhateverWorkCosts) {
  constexpr double kShare = 0.8;
  constexpr int kBlocks = 3000, kSettled = 200;
  for (const Prices::Kind kind : {Prices::Kind::drift, Prices::Kind::jumps, Prices::Kind::noise}) {
    Scene scene(kShare);
    Prices prices(kind);
    double used = 0, worst = 0;
    int missed = 0;
    for (int block = 0; block < kBlocks; ++block) {
      if (block % 16 == 0) {
        const auto object = static_cast<ObjectNumber>(block / 16 % kObjects);
        scene.player.push(strike_at((block + 2) * 128 + 17, object, Scene::impulse(object)));
      }
      scene.set_load(1.6 * prices.next());  // 1 to 6 times what the budget allows
      const double took = scene.render();
      missed += took > 1 ? 1 : 0;
      worst = std::max(worst, took);
      if (block >= kSettled) used += took / kShare / (kBlocks - kSettled);
    }
    std::printf("prices %d: uses %.2f of its time, worst block %.2f of the period\n", static_cast<int>(kind), used,
                worst);
    EXPECT_EQ(missed, 0) << static_cast<int>(kind);
    EXPECT_GE(used, 0.8) << static_cast<int>(kind);
  }
}

TEST(Shedding, AllModesComeBackWhenThereIsTimeAndAsTheyWouldHaveBeen) {
  Scene scene(0.8), whole(0);
  for (Scene* each : {&scene, &whole}) {
    set(each->mixer(), &MixerSettings::floor_db, 160);
    each->set_load(0.6);
    each->render_blocks(50);
  }
  scene.set_load(2.4);
  scene.render_blocks(100);
  EXPECT_GT(scene.muted(), 1000u);
  scene.set_load(0.3);
  int blocks = 0;
  std::uint64_t shed = 0;
  for (; (std::exchange(shed, scene.shed()) != scene.shed() || scene.muted() > 0) && blocks < 5000; ++blocks) {
    scene.render();
  }
  EXPECT_EQ(scene.muted(), 0u);
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
TEST(Shedding, SheddingDoesNotPump) {
  Scene scene(0.8);
  scene.set_load(0.6);
  scene.render_blocks(50);
  scene.set_load(2.4);
  scene.render_blocks(200);
  std::uint32_t before = scene.muted();
  double moved = 0;
  for (int block = 0; block < 375; ++block) {
    scene.render();
    moved += std::abs(static_cast<double>(scene.muted()) - before);
    before = scene.muted();
  }
  std::printf("in a second under steady load %.0f of %zu modes come or go\n", moved, kObjects * kModes);
  EXPECT_LT(moved, 0.5 * kObjects * kModes);
  scene.set_load(0.3);
  for (int second = 0; second < 3; ++second) {
    const std::uint32_t was = scene.muted();
    scene.render_blocks(static_cast<int>(4096 / kFrames));
    EXPECT_LT(static_cast<double>(was) - scene.muted(), 0.2 * kObjects * kModes);
  }
}

TEST(Shedding, ARenderWithoutADeadlineIsNeverShed) {
  Scene with(0.8, false), without(0);
  for (Scene* scene : {&with, &without}) {
    scene->set_load(4);
    scene->render_blocks(100);
  }
  EXPECT_EQ(with.player.left, without.player.left);
  EXPECT_EQ(with.shed(), 0u);
}

TEST(Shedding, ABlockWithoutOutputsKeepsToTheTimeToo) {
  Scene scene(0.8);
  scene.set_load(4);
  scene.render();
  int missed = 0;
  for (int block = 0; block < 300; ++block) {
    const std::int64_t begin = fake_now_ns;
    scene.mixer().render(Outputs(), kFrames);
    missed += static_cast<double>(fake_now_ns - begin) > kPeriod_ns ? 1 : 0;
  }
  EXPECT_EQ(missed, 0);
  EXPECT_GT(scene.muted(), kObjects * kModes / 2);
  scene.set_load(0.3);
  scene.render_blocks(3000);
  EXPECT_EQ(scene.muted(), 0u);
}

TEST(Shedding, SheddingEndsWithTheBudget) {
  Scene scene(0.8);
  scene.set_load(4);
  scene.render_blocks(100);
  EXPECT_GT(scene.muted(), 0u);
  set(scene.mixer(), &MixerSettings::budget, 0);
  scene.render_blocks(2);
  EXPECT_EQ(scene.muted(), 0u);
}

// Objects that share their states: they are shed in their sums.
TEST(Shedding, InstanceGroupsKeepToTheTimeToo) {
  int missed[2] = {0, 0};
  Samples sound[2];
  for (const bool bounded : {false, true}) {
    Player player;
    set(player.mixer, &MixerSettings::clock, kFake);
    std::vector<std::shared_ptr<ModeTable>> tables;
    for (std::uint32_t kind = 0; kind < 100; ++kind) {
      tables.push_back(std::make_shared<ModeTable>(map_of(random_bank(kind, 100, 10)), modal::MaterialScale{}, kRate));
    }
    for (ObjectNumber object = 0; object < 300; ++object) {
      ASSERT_TRUE(player.mixer.install(object, std::make_unique<Voice>(tables[object % 100]), Mixer::Install::replace));
    }
    for (ObjectNumber object = 0; object < 300; ++object)
      player.push(strike_at(0, object, Scene::impulse(object % 50)));
    fake_unit_ns = 0;
    player.render(kFrames, kFrames);
    set(player.mixer, &MixerSettings::budget, bounded ? 0.8 : 0);
    fake_unit_ns = 4 * kPeriod_ns / (100 * 100 * 2);
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
      EXPECT_EQ(player.mixer.counters().muted_modes.load(), 0u);
    } else {
      for (int block = 0; block < 2000; ++block) player.render(kFrames, kFrames);
    }
    EXPECT_EQ(player.mixer.counters().strikes.load(), 400u);
    EXPECT_EQ(player.mixer.counters().not_finite.load(), 0u);
    sound[bounded ? 1 : 0] = player.left;
  }
  std::printf("deadlines missed: %d of 400 unbounded, %d bounded\n", missed[0], missed[1]);
  EXPECT_GT(missed[0], 300);
  EXPECT_EQ(missed[1], 0);
}

// One strike may take more time than there is: it is late then, but it does not wait for ever.
TEST(Shedding, AStrikeThatCostsMoreThanABlockIsPlayedAllTheSame) {
  Scene scene(0.8);
  scene.set_load(15);  // a strike takes more than a block
  scene.render_blocks(50);
  constexpr int kBlocks = 500, kStrikes = 5;
  int missed = 0;
  for (int block = 0; block < kBlocks; ++block) {
    if (block % 100 == 10) scene.player.push(strike_at((block + 60) * 128, 3, Scene::impulse(3)));
    missed += scene.render() > 1 ? 1 : 0;
  }
  EXPECT_EQ(scene.mixer().counters().strikes.load(), std::uint64_t{kObjects} + kStrikes);
  EXPECT_LE(missed, kStrikes);
}

// As a machine does that swaps, or whose clock jumps.
TEST(Shedding, AMachineThatStoodStillIsTrustedAgain) {
  Scene scene(0.8);
  scene.set_load(0.5);
  scene.render_blocks(50);
  scene.set_load(1e5);
  scene.render_blocks(40);
  scene.set_load(0.5);
  scene.player.push(strike_at(0, 3, Scene::impulse(3)));
  scene.render_blocks(3000);
  EXPECT_EQ(scene.mixer().counters().strikes.load(), kObjects + 1u);
  EXPECT_EQ(scene.muted(), 0u);
}

TEST(Shedding, OneDisturbedBlockCostsNothing) {
  Scene with(0.8), without(0);
  for (Scene* scene : {&with, &without}) {
    scene->set_load(0.5);
    scene->render_blocks(100);
    scene->set_load(0.75);  // once
    scene->render();
    scene->set_load(0.5);
    scene->render_blocks(100);
  }
  EXPECT_EQ(with.player.left, without.player.left);
  EXPECT_EQ(with.shed(), 0u);
}

// Where there is little to do, leaving it out would not win back the time that another program took.
TEST(Shedding, ADisturbanceLeavesASmallSceneAsItIs) {
  Scene with(0.8), without(0);
  for (Scene* scene : {&with, &without}) {
    scene->set_load(0.15);
    for (int i = 0; i < 100; ++i) {
      if (i > 20 && i % 7 == 0) fake_stall_ns = static_cast<std::int64_t>(0.9 * kPeriod_ns);
      scene->render();
    }
  }
  EXPECT_EQ(with.player.left, without.player.left);
  EXPECT_EQ(with.shed(), 0u);
}

TEST(Shedding, SheddingIsRealTimeSafe) {
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
