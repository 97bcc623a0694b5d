// How events wait: in how little memory, and what happens where there is no room.
#include "engine/synth/events/event_queue.h"
#include "tests/synth/player.h"

#include <malloc.h>

namespace ringdown::synth::test {
namespace {

verb::Contact contact_of(std::uint32_t number) {
  return {{1, 1, 1}, {.number = number, .force_n = {0, 0, -1}, .slip_m_s = 0.1}};
}

TEST(EventQueue, AnEventThatWaitsIsSmallAndAnIdleMixerTakesLittle) {
  static_assert(sizeof(QueuedEvent) <= 80);
  const auto held = [] {
    const struct mallinfo2 all = mallinfo2();
    return all.uordblks + all.hblkhd;
  };
  const std::size_t before = held();
  const auto mixer = std::make_unique<Mixer>(kRate);
  EXPECT_LT(held() - before, std::size_t{4'000'000});
}

TEST(EventQueue, GivesBackWhatWasPushedWhereverItWaited) {
  EventQueue queue;
  queue.make_room();
  const verb::Strike strike{{1, 2, 3}, {4, 5, 6}, 0.125};
  const verb::Couple couple{.point_m = {1, 0, 0}, .other = 7, .direction = {0, 0, 1}, .gap_m = -0.001, .number = 3};
  ASSERT_TRUE(queue.push(Producer::control, {20, 5, couple}));
  ASSERT_TRUE(queue.push(Producer::midi, {10, 4, strike}));
  verb::Pose placed;
  int placings = 0;
  ASSERT_TRUE(queue.push(Producer::scene, {5, 1, verb::Pose{{{1, 2, 3}, {}}}}));
  const auto place = [&](const Event& event) {
    placed = event.verb.get<verb::Pose>();
    ++placings;
  };
  EXPECT_EQ(queue.accept(0, place), 0u);
  EXPECT_EQ(placings, 1);
  EXPECT_EQ(placed.pose.position_m, (Vec3{1, 2, 3}));
  const auto take = [&] {
    const QueuedEvent queued = queue.next_before(100)->event;
    const Event event = queue.event_of(queued);
    queue.pop();
    queue.release(queued);
    return event;
  };
  const Event first = take(), second = take();
  EXPECT_EQ(first.frame, 10);
  EXPECT_EQ(first.object, 4u);
  EXPECT_EQ(first.verb.get<verb::Strike>().impulse_ns, strike.impulse_ns);
  EXPECT_EQ(first.verb.get<verb::Strike>().contact_time_s, 0.125);
  EXPECT_EQ(second.object, 5u);
  EXPECT_EQ(second.verb.get<verb::Couple>().other, 7u);
  EXPECT_EQ(second.verb.get<verb::Couple>().gap_m, -0.001);
  EXPECT_EQ(second.verb.get<verb::Couple>().number, 3u);
  EXPECT_EQ(queue.next_before(kNever), nullptr);
}

TEST(EventQueue, ContactsFillRingAndQueueAndAreTakenAgainWhenTheyAreOver) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 5)));
  player.render(512);
  for (int round = 0; round < 3; ++round) {
    const Frame later = player.mixer.counters().frames.load() + 24000;
    const auto push_all = [&] {
      std::size_t taken = 0;
      while (player.mixer.push(Producer::control, {later, 0, contact_of(taken % 4)})) ++taken;
      return taken;
    };
    std::size_t taken = push_all();
    for (std::size_t more = 1; more > 0; taken += more) {
      player.mixer.render({}, {});  // the ring's events move to the queue
      more = push_all();
    }
    EXPECT_EQ(taken, kQueueCapacity + kMaxPendingEvents) << round;
    player.render(36000);
  }
}

TEST(EventQueue, AProducerWithoutPlacesIsRefusedContactsAndNoStrikes) {
  Player player;
  player.install(0, map_of(single_mode_bank(440, 5)));
  EXPECT_TRUE(player.mixer.push(Producer::worker, {0, 0, contact_of(0)}));
  EXPECT_TRUE(player.mixer.push(Producer::worker, {0, 0, contact_of(1)}));
  EXPECT_FALSE(player.mixer.push(Producer::worker, {0, 0, contact_of(2)}));
  EXPECT_TRUE(player.mixer.push(Producer::worker, strike_at(0, 0, {0, 0, 1})));
  player.render(4096);
  EXPECT_EQ(player.mixer.counters().strikes, 1u);
  EXPECT_TRUE(player.mixer.push(Producer::worker, {4096, 0, contact_of(2)})) << "places are given back";
}

TEST(EventQueue, ABlowOrAPoseOfAnObjectThatNeverWasIsRefused) {
  Player player;
  player.push(gain_at(0, 17, 0.5));
  player.push(strike_at(10, 18, {0, 0, 1}));
  player.push({0, 19, verb::Pose{}});
  player.render(256);
  EXPECT_EQ(player.mixer.counters().refused, 2u) << "gains count only where they are out of range";
  EXPECT_EQ(peak(player.left), 0);
}

}  // namespace
}  // namespace ringdown::synth::test
