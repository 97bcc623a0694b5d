// Every capacity at its limit and one past it: nothing lost in silence.
#include "tests/synth/player.h"

#include <gtest/gtest.h>

namespace ringdown::synth::test {
namespace {

TEST(Limits, APushPastTheRingsCapacityIsRefused) {
  Player player;
  for (std::size_t i = 0; i < kQueueCapacity; ++i) {
    ASSERT_TRUE(player.mixer.push(Producer::scene, strike_at(0, 0, {0, 0, 1}))) << i;
  }
  EXPECT_FALSE(player.mixer.push(Producer::scene, strike_at(0, 0, {0, 0, 1})));
  EXPECT_TRUE(player.mixer.push(Producer::control, strike_at(0, 0, {0, 0, 1}))) << "each producer has its own ring";
  player.render(64);
  EXPECT_TRUE(player.mixer.push(Producer::scene, strike_at(0, 0, {0, 0, 1})));
}

TEST(Limits, EveryObjectNumberUpToTheLimitPlays) {
  Player player;
  const Map map = map_of(single_mode_bank(1000, 5));
  for (ObjectNumber object = 0; object < kMaxObjects; ++object) {
    player.install(object, map);
    player.push(strike_at(0, object, {0, 0, 0.001}));
  }
  player.render(64 * (kMaxObjects / kMaxEventsPerChunk + 1));
  EXPECT_EQ(player.mixer.counters().strikes, kMaxObjects);
  EXPECT_EQ(player.mixer.counters().ringing_voices, kMaxObjects);
}

TEST(Limits, OneVoiceTooManyIsRefusedAndACollectedOneMakesRoom) {
  Player player;
  const Map map = map_of(single_mode_bank(1000, 5));
  for (std::size_t i = 0; i < kMaxVoices; ++i) {
    player.install(static_cast<ObjectNumber>(i % 2), map);
    if (i % 1000 == 999) player.render(64);
  }
  EXPECT_FALSE(player.mixer.install(0, voice_of(map), Mixer::Install::replace));
  player.render(64);  // none was ever struck: all but two come back
  EXPECT_FALSE(player.mixer.install(0, voice_of(map), Mixer::Install::replace));
  player.mixer.collect();
  for (std::size_t i = 2; i < kMaxVoices; ++i) player.install(3, map);
  EXPECT_FALSE(player.mixer.install(3, voice_of(map), Mixer::Install::replace));
}

TEST(Limits, RemovalsPastTheCommandRingAreRefused) {
  Player player;
  std::size_t taken = 0;
  while (player.mixer.remove(0)) ASSERT_LE(++taken, std::size_t{1} << 20);
  EXPECT_GE(taken, kMaxVoices + kMaxObjects);
  EXPECT_FALSE(player.mixer.install(0, voice_of(map_of(single_mode_bank(1000, 5))), Mixer::Install::replace));
  EXPECT_FALSE(player.mixer.in_use(0));
  player.render(64);
  EXPECT_TRUE(player.mixer.remove(0));
}

// Events beyond those the mixer may hold wait in their rings, and none is lost.
TEST(Limits, PendingEventsBeyondTheLimitWaitInTheirRings) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 5)));
  constexpr Frame kLater = 100000;
  for (std::size_t i = 0; i < kMaxPendingEvents; ++i) {
    ASSERT_TRUE(player.mixer.push(Producer::control, strike_at(kLater, 0, {0, 0, 1e-4})));
    if (i % kQueueCapacity == kQueueCapacity - 1) player.render(64);
  }
  for (std::size_t i = 0; i < kQueueCapacity; ++i) player.push(strike_at(kLater, 0, {0, 0, 1e-4}));
  player.render(64);
  EXPECT_FALSE(player.mixer.push(Producer::control, strike_at(kLater, 0, {0, 0, 1e-4})))
      << "with the mixer full, the ring stays full";
  player.render(kLater + 64 * 64);
  EXPECT_EQ(player.mixer.counters().strikes, kMaxPendingEvents + kQueueCapacity);
}

TEST(Limits, EventsBeyondThoseOfOneChunkPlayInTheNext) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 5)));
  for (std::size_t i = 0; i < kMaxEventsPerChunk; ++i) player.push(strike_at(10, 0, {0, 0, 1e-4}));
  player.render(kChunkFrames);
  EXPECT_EQ(player.mixer.counters().strikes, kMaxEventsPerChunk);
  for (std::size_t i = 0; i <= kMaxEventsPerChunk; ++i) player.push(strike_at(74, 0, {0, 0, 1e-4}));
  player.render(kChunkFrames);
  EXPECT_EQ(player.mixer.counters().strikes, 2 * kMaxEventsPerChunk);
  player.render(kChunkFrames);
  EXPECT_EQ(player.mixer.counters().strikes, 2 * kMaxEventsPerChunk + 1);
}

TEST(Limits, AVertexPastTheLastIsRefusedAndCounted) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 5)));
  player.push(vertex_strike_at(0, 0, 3, {0, 0, 1}));
  player.push(vertex_strike_at(0, 0, 4, {0, 0, 1}));
  player.push(vertex_strike_at(0, 0, 0xffffffff, {0, 0, 1}));
  player.render(64);
  EXPECT_EQ(player.mixer.counters().strikes, 1u);
  EXPECT_EQ(player.mixer.counters().refused, 2u);
}

}  // namespace
}  // namespace ringdown::synth::test
