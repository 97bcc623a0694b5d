// The time budget: what is left out when time is short, that blocks keep to their time, and that all comes back.
#include "engine/synth/budget.h"

#include "tests/support/realtime_guard.h"
#include "tests/synth/player.h"

#include <cmath>
#include <cstdio>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

// Time that passes only by work.
std::int64_t fake_now_ns = 0;
double fake_unit_ns = 0;
std::int64_t fake_stall_ns = 0;  // once
std::int64_t fake_read_ns = 0;   // each time the clock is read
std::int64_t fake_clock() RINGDOWN_REALTIME { return fake_now_ns += fake_read_ns; }
void fake_work(double units) RINGDOWN_REALTIME {
  fake_now_ns += static_cast<std::int64_t>(units * fake_unit_ns) + std::exchange(fake_stall_ns, 0);
}
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
      budget.open_chunk(25, 0);
      budget.worked(10000);
      budget.close_chunk(10000);
    }
  }
  budget.open_block(100, 1e5, true);
  budget.open_chunk(25, 0);
  EXPECT_NEAR(budget.usual(), 0.5 * kBlock_ns / 4 / 10, 50);
  EXPECT_FALSE(budget.over(12000));
  EXPECT_TRUE(budget.over(13000));
  fake_now_ns += kBlock_ns / 8 + 1;
  EXPECT_TRUE(budget.over(0));
  budget.open_chunk(25, 0);
  EXPECT_FALSE(budget.over(0)) << "the other chunks share what is left";
  EXPECT_NEAR(budget.usual(), 0.5 * kBlock_ns / 4 / 10, 50);
}

// A small scene on a machine that now and then takes some time for itself: it is to cost what it costs on average, not
// what it does at worst.
TEST(Budget, DisturbancesOfChunksThatDoLittleAreNoAlarm) {
  constexpr double kUnit_ns = 10, kUnits = 1000, kDisturbance_ns = 30000, kChunk_ns = 0.5 * kBlock_ns;
  fake_unit_ns = kUnit_ns;
  Budget budget;
  budget.set_clock(kFake);
  budget.set_share(0.5);
  for (int block = 0; block < 2000; ++block) {
    budget.open_block(100, 1e5, true);
    budget.open_chunk(100, 0);
    budget.worked(kUnits);
    if (block % 4 < 2) fake_now_ns += static_cast<std::int64_t>(kDisturbance_ns);  // twice on end, so it is believed
    budget.close_chunk(kUnits);
  }
  const double average_ns = kUnit_ns + 0.5 * kDisturbance_ns / kUnits;
  EXPECT_GE(budget.usual(), 0.9 * kChunk_ns / average_ns);
  EXPECT_LE(budget.usual(), kChunk_ns / kUnit_ns);
}

TEST(Budget, BlocksWithoutALimitOrADeadlineAreNeverOver) {
  for (const double share : {0.0, 0.5}) {
    Budget budget;
    budget.set_clock(kFake);
    budget.set_share(share);
    budget.open_block(100, 1e5, share == 0);
    budget.open_chunk(100, 0);
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

// The clock is read at each object, so this is what objects cost that are only come by, as large ones do, far away in
// memory. Taken for the price of modes it would let ever fewer of them sound, in the end none.
TEST(Shedding, WhatSilentObjectsCostDoesNotSilenceTheOthers) {
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

TEST(Shedding, WhatNobodyListensToKeepsToTheTimeToo) {
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
  EXPECT_GT(scene.hidden(), kObjects * kModes / 2);
  scene.set_load(0.3);
  scene.render_blocks(3000);
  EXPECT_EQ(scene.hidden(), 0u);
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
  int missed[2] = {0, 0};
  Samples sound[2];
  for (const bool bounded : {false, true}) {
    Player player;
    player.mixer.set_clock(kFake);
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
    player.mixer.set_budget(bounded ? 0.8 : 0);
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
      EXPECT_EQ(player.mixer.counters().hidden_modes.load(), 0u);
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
  EXPECT_EQ(scene.hidden(), 0u);
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

// The periods of these modes divide a chunk, and they hardly decay: events that are late by some chunks make no
// difference once they have happened.
modal::Bank patient_bank(std::uint32_t seed, std::size_t modes) {
  modal::Bank bank = random_bank(seed, modes, 10);
  for (std::size_t i = 0; i < modes; ++i) {
    bank.frequency_hz[i] = kRate / kFrames * static_cast<double>(1 + (7 * i) % 60);
    bank.decay_per_s[i] = 1e-4;
  }
  return bank;
}

// Objects of some kinds, played at random while there is too little time, and then with time enough.
class RandomScore {
 public:
  RandomScore(std::uint32_t seed, double share)
      : random_(seed), kinds_(60 + below(100)), objects_(kinds_ + below(200)), modes_(20 + below(60)) {
    player.mixer.set_clock(kFake);
    for (std::uint32_t kind = 0; kind < kinds_; ++kind) {
      tables_.push_back(std::make_shared<ModeTable>(map_of(patient_bank(kind, modes_)), modal::MaterialScale{}, kRate));
    }
    for (ObjectNumber object = 0; object < objects_; ++object) {
      install(object);
      player.push(strike_at(0, object, {0, 0.01, 0}));
    }
    sent = objects_;
    fake_unit_ns = 0;
    player.render(kFrames, kFrames);
    player.mixer.set_budget(share);
    fake_unit_ns = 0.5 * (2 + below(7)) * kPeriod_ns / static_cast<double>(2 * kinds_ * modes_);
  }

  // Returns how many of the blocks are late.
  int play(int blocks) {
    int missed = 0;
    for (; blocks > 0; --blocks) {
      push_some(player.mixer.counters().frames.load() + static_cast<Frame>(kFrames));
      const std::int64_t begin = fake_now_ns;
      player.render(kFrames, kFrames);
      missed += static_cast<double>(fake_now_ns - begin) > kPeriod_ns ? 1 : 0;
    }
    return missed;
  }
  Samples rest(int blocks) {
    fake_unit_ns /= 100;
    player.render(static_cast<std::size_t>(blocks) * kFrames, kFrames);
    return {player.left.end() - 50 * kFrames, player.left.end()};
  }
  [[nodiscard]] const MixerCounters& counters() const { return player.mixer.counters(); }

  Player player;
  std::uint64_t sent = 0;  // strikes

 private:
  std::uint32_t below(std::uint32_t n) { return random_() % n; }
  ObjectNumber any() { return below(objects_); }
  void install(ObjectNumber object) {
    EXPECT_TRUE(
        player.mixer.install(object, std::make_unique<Voice>(tables_[object % kinds_]), Mixer::Install::replace));
  }
  void push_some(Frame frame) {
    for (std::uint32_t i = below(6) == 0 ? below(20) : 0; i > 0; --i, ++sent) {
      player.push(strike_at(frame + static_cast<Frame>(kFrames * below(3)), any(), {0, 0.01 * (1 + below(3)), 0}));
    }
    for (std::uint32_t i = below(8) == 0 ? below(4) : 0; i > 0; --i) {
      const ObjectNumber object = any();
      for (int twice = 0; twice < 2; ++twice) player.push(gain_at(frame, object, 0.5 + 0.1 * below(5), 0.01));
      player.push(pan_at(frame, any(), 0.1 * below(9) - 0.4, 0.01));
    }
    if (below(40) == 0) install(any());
  }

  std::mt19937 random_;
  std::uint32_t kinds_, objects_;
  std::size_t modes_;
  std::vector<std::shared_ptr<ModeTable>> tables_;
};

TEST(Shedding, NothingIsLostOrPlayedTwice) {
  constexpr int kBlocks = 200, kUntilAllIsBack = 3000;
  int missed[2] = {0, 0};
  double worst_db = -400;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    Samples sound[2];
    for (const int bounded : {0, 1}) {
      RandomScore score(seed, 0.8 * bounded);
      missed[bounded] += score.play(kBlocks);
      sound[bounded] = score.rest(kUntilAllIsBack);
      EXPECT_EQ(score.counters().strikes.load(), score.sent) << "score " << seed;
      EXPECT_EQ(score.counters().hidden_modes.load(), 0u) << "score " << seed;
      EXPECT_EQ(score.counters().not_finite.load(), 0u) << "score " << seed;
    }
    worst_db = std::max(worst_db, relative_error_db(sound[1], sound[0]));
  }
  std::printf("of %d blocks are late: %d unbounded, %d bounded; then they differ by %.0f dB\n", 8 * kBlocks, missed[0],
              missed[1], worst_db);
  EXPECT_GT(missed[0], 4 * kBlocks);
  EXPECT_EQ(missed[1], 0);
  EXPECT_LT(worst_db, -80);
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
