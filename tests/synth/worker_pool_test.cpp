// Several threads: everything is done once, and the mix is that of one thread to rounding.
#include "engine/synth/worker_pool.h"
#include "tests/synth/player.h"

#include <atomic>
#include <chrono>
#include <random>

namespace ringdown::synth::test {
namespace {

TEST(WorkerPool, TheWorkerPoolDoesEveryItemOnceInEveryRound) {
  for (const std::size_t helpers : {0, 1, 3}) {
    std::vector<std::atomic<int>> done(300);
    std::vector<std::atomic<int>> by(helpers + 1);
    WorkerPool pool(helpers, [&](std::size_t item, std::size_t who) {
      ++done[item];
      ++by[who];
    });
    for (int round = 1; round <= 2000; ++round) {
      const std::size_t count = static_cast<std::size_t>(round) % 301;
      for (auto& d : done) d = 0;
      pool.run(count);
      for (std::size_t i = 0; i < done.size(); ++i) ASSERT_EQ(done[i], i < count ? 1 : 0) << helpers << ", " << round;
    }
    EXPECT_GT(by[0], 0);
  }
}

TEST(WorkerPool, HelpersOfTheWorkerPoolDoPartOfTheWork) {
  std::atomic<int> by_helpers = 0;
  WorkerPool pool(1, [&](std::size_t, std::size_t who) {
    by_helpers += who == 1 ? 1 : 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(50);
    while (std::chrono::steady_clock::now() < end) {
    }
  });
  for (int round = 0; round < 20000 && by_helpers == 0; ++round) pool.run(100);
  EXPECT_GT(by_helpers, 0);
}

// 80 objects of 100 modes, struck, moved and replaced as they ring.
std::unique_ptr<Player> play(std::size_t threads) {
  auto player = std::make_unique<Player>();
  set(player->mixer, &MixerSettings::threads, threads);
  std::mt19937 random(5);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  for (ObjectNumber object = 0; object < 80; ++object) player->install(object, map_of(random_bank(object, 100, 20)));
  for (int round = 0; round < 10; ++round) {
    const auto begin = static_cast<Frame>(player->left.size());
    for (int i = 0; i < 100; ++i) {
      const auto object = static_cast<ObjectNumber>(random() % 80);
      const auto frame = begin + static_cast<Frame>(uniform() * 1000);
      player->push(vertex_strike_at(frame, object, static_cast<std::uint32_t>(random() % 20), {10, 20 * uniform(), 5}));
      if (i % 20 == 0) player->push(gain_at(frame + 5, object, uniform(), 0.01));
      if (i % 50 == 0) player->push(clear_at(frame + 50, object));
    }
    player->install(static_cast<ObjectNumber>(round), map_of(random_bank(200 + round, 100, 20)));
    player->render(2000, 256);
    player->mixer.collect();
  }
  return player;
}

TEST(MixerThreads, SeveralThreadsSoundLikeOne) {
  const auto alone = play(1);
  const double loudest = peak(alone->left);
  EXPECT_GT(alone->mixer.counters().ringing_modes, 4000u);
  for (const std::size_t threads : {2, 4}) {
    const auto together = play(threads);
    EXPECT_EQ(together->mixer.counters().strikes, alone->mixer.counters().strikes);
    EXPECT_EQ(together->mixer.counters().ringing_modes, alone->mixer.counters().ringing_modes);
    for (std::size_t n = 0; n < alone->left.size(); ++n) {
      ASSERT_NEAR(together->left[n], alone->left[n], 2e-6 * loudest) << n;
      ASSERT_NEAR(together->right[n], alone->right[n], 2e-6 * loudest) << n;
    }
  }
}

}  // namespace
}  // namespace ringdown::synth::test
