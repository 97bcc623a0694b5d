// Objects of one table share their states: the same sound as each of them alone, for the price of two banks.
#include "tests/synth/player.h"

#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr std::size_t kModes = 40;

// Modes from 40 Hz to 19 kHz, some of which die within a few chunks.
Map coin() { return map_of(random_bank(5, kModes, 30)); }

// The same things happen to two mixers: in one the objects share a table, in the other each has its own.
class Pair {
 public:
  Pair(std::size_t objects, double rate = kRate) : map(coin()), table(new_table(rate)) {
    for (ObjectNumber object = 0; object < objects; ++object) install(object);
  }

  std::shared_ptr<ModeTable> new_table(double rate = kRate, const modal::MaterialScale& material = {}) const {
    return std::make_shared<ModeTable>(map, material, rate);
  }
  void install(ObjectNumber object, Mixer::Install how = Mixer::Install::replace) {
    install(object, table, new_table(), how);
  }
  void install(ObjectNumber object, std::shared_ptr<ModeTable> common, std::shared_ptr<ModeTable> own,
               Mixer::Install how) {
    ASSERT_TRUE(shared.mixer.install(object, std::make_unique<Voice>(std::move(common)), how));
    ASSERT_TRUE(alone.mixer.install(object, std::make_unique<Voice>(std::move(own)), how));
  }
  void push(const Event& event) { shared.push(event), alone.push(event); }
  void render(std::size_t frames, std::size_t block = 256) {
    shared.render(frames, block), alone.render(frames, block);
  }
  // Of the loudest sample of either channel.
  [[nodiscard]] double difference() const {
    double largest = 0, loudest = 0;
    for (const auto& [a, b] : {std::pair{&shared.left, &alone.left}, std::pair{&shared.right, &alone.right}}) {
      for (std::size_t n = 0; n < a->size(); ++n) {
        largest = std::max(largest, std::abs((*a)[n] - (*b)[n]));
        loudest = std::max(loudest, std::abs((*b)[n]));
      }
    }
    EXPECT_GT(loudest, 0);
    return largest / loudest;
  }
  [[nodiscard]] std::uint32_t modes() const { return shared.mixer.counters().ringing_modes; }

  Map map;
  std::shared_ptr<ModeTable> table;
  Player shared, alone;
};

// Rounding of the float sums, which are other sums in the two mixers.
constexpr double kSame = 2e-6;

TEST(InstanceGroup, AThousandCoinsSoundAsEachAloneForThePriceOfTwoBanks) {
  Pair pair(1000);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> size(-1, 1);
  std::uniform_int_distribution<Frame> when(0, 20000);
  for (ObjectNumber object = 0; object < 1000; ++object) {
    pair.push(pan_at(0, object, size(random)));
    pair.push(gain_at(0, object, 1 + size(random)));
    pair.push(strike_at(1000 + when(random), object, {size(random), size(random), size(random)}));
  }
  pair.render(24000);
  EXPECT_LE(pair.difference(), kSame);
  EXPECT_LE(pair.modes(), 2 * kModes);
  EXPECT_EQ(pair.shared.mixer.counters().ringing_voices, 1000u);
  EXPECT_EQ(pair.alone.mixer.counters().ringing_modes, 1000 * kModes);
}

TEST(InstanceGroup, GainAndPanMoveOneObjectAlone) {
  Pair pair(3);
  for (ObjectNumber object = 0; object < 3; ++object) pair.push(strike_at(100 + 37 * object, object, {1, 0.2, 0.1}));
  pair.push(gain_at(3000, 1, 0.1, 0.05));
  pair.push(pan_at(9000, 2, 0.8));
  pair.push(strike_at(9100, 2, {0.3, 1, 0}));
  pair.push(gain_at(20000, 1, 2, 0));
  pair.render(40000, 192);
  EXPECT_LE(pair.difference(), kSame);
  EXPECT_LE(pair.modes(), 2 * kModes) << "still again, all share";
}

TEST(InstanceGroup, ClearedRemovedAndRetunedObjectsLeaveTheirInstanceGroup) {
  Pair pair(5);
  for (ObjectNumber object = 0; object < 5; ++object) pair.push(strike_at(64, object, {1, 0.2, 0.1}));
  pair.push(clear_at(5000, 0));
  pair.render(8000);
  ASSERT_TRUE(pair.shared.mixer.remove(1));
  ASSERT_TRUE(pair.alone.mixer.remove(1));
  const modal::MaterialScale stiffer{.stiffness = 1.2};
  pair.install(2, pair.new_table(kRate, stiffer), pair.new_table(kRate, stiffer), Mixer::Install::retune);
  pair.install(3, Mixer::Install::replace);
  pair.render(8000);
  pair.push(strike_at(16500, 3, {0, 1, 0}));
  pair.render(8000);
  EXPECT_LE(pair.difference(), kSame);
}

TEST(InstanceGroup, AnInstanceGroupSoundsTheSameAtAnyBlockSize) {
  for (const std::size_t block : {1u, 63u, 128u, 1000u}) {
    Pair pair(20);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> size(-1, 1);
    for (int i = 0; i < 200; ++i) {
      pair.push(strike_at(static_cast<Frame>(random() % 6000), random() % 20, {size(random), size(random), 0}));
    }
    pair.push(gain_at(2222, 7, 0.5, 0.01));
    pair.render(8000, block);
    EXPECT_LE(pair.difference(), kSame) << "blocks of " << block;
  }
}

// What an object keeps for itself is moved on in one jump of ten minutes; then it is taken out of the sum.
TEST(InstanceGroup, AnObjectLeavesItsInstanceGroupExactlyAfterTenMinutes) {
  const auto table = std::make_shared<ModeTable>(map_of(single_mode_bank(440, 1e-3)), modal::MaterialScale{}, kRate);
  Mixer mixer(kRate);
  for (ObjectNumber object = 0; object < 2; ++object) {
    ASSERT_TRUE(mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
  }
  ASSERT_TRUE(mixer.push(Producer::control, strike_at(0, 0, {1, 1, 1})));
  std::vector<float> left(8192), right(8192);
  float loudest = 0;
  for (int second = 0; second < 600; ++second) {
    for (int i = 0; i < 6; ++i) mixer.render(left, right);
    loudest = std::max(loudest, mixer.counters().peak.load());
  }
  const Frame now = mixer.counters().frames;
  ASSERT_TRUE(mixer.push(Producer::control, gain_at(now, 0, 0, 0.005)));
  mixer.render(left, right);
  set(mixer, &MixerSettings::floor_db, 300);
  mixer.render(left, right);
  EXPECT_GT(loudest, 0.01);
  EXPECT_LE(static_cast<double>(mixer.counters().peak.load()), 1e-7 * static_cast<double>(loudest));
}

TEST(InstanceGroup, AStrikeAndAClearInOneChunkHappenInTheirOrder) {
  Pair pair(3);
  for (ObjectNumber object = 0; object < 3; ++object) {
    pair.push(strike_at(70, object, {1, 0.2, 0.1}));
    pair.push(clear_at(90, object));
    pair.push(strike_at(100, object, {0.1, 0.2, 0.1}));
    pair.push(gain_at(110, object, 0.5));
  }
  pair.render(4000);
  EXPECT_LE(pair.difference(), kSame);
  EXPECT_EQ(pair.shared.mixer.counters().strikes, 6u);
  EXPECT_EQ(pair.shared.mixer.counters().refused, 0u);
}

TEST(InstanceGroup, AnInstanceGroupIsOfOneBankInOneMaterial) {
  Mixer mixer(kRate);
  const Map map = coin(), other = coin();
  const auto table = mixer.table_for(map, {});
  ASSERT_TRUE(mixer.install(0, std::make_unique<Voice>(table), Mixer::Install::replace));
  EXPECT_EQ(mixer.table_for(map, {}), table);
  EXPECT_NE(mixer.table_for(other, {}), table);
  EXPECT_NE(mixer.table_for(map, {.alpha = 2}), table);
}

TEST(InstanceGroup, AnAbsurdStrikeIsNotHeard) {
  Pair pair(4);
  for (ObjectNumber object = 0; object < 4; ++object) pair.shared.push(strike_at(64, object, {1, 0.2, 0.1}));
  for (ObjectNumber object = 0; object < 4; ++object) pair.alone.push(strike_at(64, object, {1, 0.2, 0.1}));
  pair.shared.push(strike_at(2000, 1, {1e300, 1e300, 1e300}));
  pair.render(8000);
  EXPECT_LE(pair.difference(), kSame);
  EXPECT_EQ(pair.shared.mixer.counters().not_finite, 1u);
}

TEST(InstanceGroup, ObjectsOnOneBusShareAnInstanceGroupAndOthersDoNot) {
  Pair pair(6);
  std::vector<float> bus_shared(6400), bus_alone(6400), left(6400), right(6400);
  for (ObjectNumber object = 0; object < 5; ++object) {
    ASSERT_TRUE(pair.shared.mixer.assign(object, 3));
    ASSERT_TRUE(pair.alone.mixer.assign(object, 3));
  }
  for (ObjectNumber object = 0; object < 6; ++object) pair.push(strike_at(64 + 50 * object, object, {1, 0.2, 0.1}));
  double largest = 0, loudest = 0;
  for (const auto& [player, bus] : {std::pair{&pair.shared, &bus_shared}, std::pair{&pair.alone, &bus_alone}}) {
    Outputs outputs(left.data(), right.data());
    outputs.listen_to_bus(3, bus->data());
    player->mixer.render(outputs, left.size());
  }
  for (std::size_t n = 0; n < bus_alone.size(); ++n) {
    largest = std::max(largest, std::abs(static_cast<double>(bus_shared[n]) - static_cast<double>(bus_alone[n])));
    loudest = std::max(loudest, std::abs(static_cast<double>(bus_alone[n])));
  }
  EXPECT_GT(loudest, 0);
  EXPECT_LE(largest / loudest, kSame);
  EXPECT_EQ(pair.modes(), 4 * kModes) << "left, right, the bus; and the object that is not on it";
}

}  // namespace
}  // namespace ringdown::synth::test
