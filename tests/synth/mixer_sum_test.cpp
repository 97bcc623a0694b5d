// Many modes at once, where the mixer sums moments: against the closed form, and across every way to cut time.
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>

namespace ringdown::synth::test {
namespace {

using modal::Bank;

constexpr std::size_t kPoints = 40;

struct Strike {
  ObjectNumber object;
  Frame frame;
  std::uint32_t vertex;
  Vec3 impulse;
};

struct Scene {
  std::vector<Bank> banks;
  std::vector<double> gain, pan;
  std::vector<Strike> strikes;

  Scene(std::size_t objects, std::size_t modes, std::size_t strike_count, Frame length) {
    std::mt19937 random(11);
    const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
    for (std::size_t o = 0; o < objects; ++o) {
      banks.push_back(random_bank(static_cast<std::uint32_t>(o), modes, kPoints));
      gain.push_back(0.2 + uniform());
      pan.push_back(2 * uniform() - 1);
    }
    for (std::size_t i = 0; i < strike_count; ++i) {
      // Each object rings from the start, loud enough that the floor is far away.
      const auto object = static_cast<ObjectNumber>(i % objects);
      const Frame frame = i < objects ? 300 : 300 + static_cast<Frame>(uniform() * static_cast<double>(length));
      strikes.push_back({object,
                         frame,
                         static_cast<std::uint32_t>(random() % kPoints),
                         {3e3 * uniform(), 3e3 * uniform(), 3e3 * (uniform() - 0.5)}});
    }
  }

  [[nodiscard]] std::unique_ptr<Player> play(std::size_t frames, std::size_t block) const {
    auto player = std::make_unique<Player>();
    for (std::size_t o = 0; o < banks.size(); ++o) {
      const auto object = static_cast<ObjectNumber>(o);
      player->install(object, map_of(banks[o]));
      player->push(gain_at(0, object, gain[o]));
      player->push(pan_at(0, object, pan[o]));
    }
    for (const Strike& s : strikes) player->push(vertex_strike_at(s.frame, s.object, s.vertex, s.impulse));
    player->render(frames, block);
    return player;
  }

  // The left and right channel from frame `first` on.
  [[nodiscard]] std::array<Samples, 2> exact(Frame first, std::size_t count) const {
    std::array<Samples, 2> sum{Samples(count, 0.0), Samples(count, 0.0)};
    for (const Strike& s : strikes) {
      const Bank& bank = banks[s.object];
      const double angle = (1 + pan[s.object]) * std::numbers::pi / 4;
      for (std::size_t m = 0; m < bank.mode_count(); ++m) {
        const auto& shape = bank.shape(m, s.vertex);
        const double along = shape[0] * s.impulse.x + shape[1] * s.impulse.y + shape[2] * s.impulse.z;
        const double omega = 2 * std::numbers::pi * bank.frequency_hz[m];
        const double scale = gain[s.object] * ringdown::test::kLoudness * omega * along;
        for (std::size_t n = 0; n < count; ++n) {
          const Frame since = first + static_cast<Frame>(n) - s.frame;
          if (since < 0) continue;
          const long double t = static_cast<long double>(since) / static_cast<long double>(kRate);
          const auto value = static_cast<double>(std::exp(-bank.decay_per_s[m] * t) * std::sin(omega * t));
          sum[0][n] += scale * std::cos(angle) * value;
          sum[1][n] += scale * std::sin(angle) * value;
        }
      }
    }
    return sum;
  }
};

// Objects in the middle are added to both channels at once: all of them, or some among others.
TEST(MixerSum, ObjectsInTheMiddleAddUpToTheClosedForm) {
  for (const std::size_t every : {1, 3}) {
    Scene scene(40, 50, 60, 500);
    for (std::size_t o = 0; o < scene.pan.size(); o += every) scene.pan[o] = 0;
    const auto player = scene.play(1200, 128);
    const std::array<Samples, 2> exact = scene.exact(900, 250);
    for (const auto& [heard, wanted] : {std::pair{&player->left, &exact[0]}, {&player->right, &exact[1]}}) {
      EXPECT_LT(relative_error_db(Samples(heard->begin() + 900, heard->begin() + 1150), *wanted), -110) << every;
    }
  }
}

TEST(MixerSum, TheSumOfTwoThousandModesIsTheClosedForm) {
  const Scene scene(40, 50, 120, 4000);
  for (const std::size_t block : {128, 256, 441, 77}) {
    const auto player = scene.play(5400, block);
    for (const Frame first : {0, 3000, 5000}) {
      const std::array<Samples, 2> exact = scene.exact(first, 400);
      const auto from = static_cast<std::ptrdiff_t>(first);
      for (const auto& [heard, wanted] : {std::pair{&player->left, &exact[0]}, {&player->right, &exact[1]}}) {
        const double error = relative_error_db(Samples(heard->begin() + from, heard->begin() + from + 400), *wanted);
        EXPECT_LT(error, -110) << "block " << block << ", from frame " << first;
      }
    }
    EXPECT_GT(player->mixer.counters().ringing_modes, 1500u);
  }
}

TEST(MixerSum, TheSumStaysTheClosedFormAfterASecond) {
  const Scene scene(20, 100, 20, 0);
  const auto player = scene.play(50000, 128);
  const std::array<Samples, 2> exact = scene.exact(48300, 500);
  const double error = relative_error_db(Samples(player->left.begin() + 48300, player->left.begin() + 48800), exact[0]);
  std::printf("2,000 modes against the closed form after a second: %.1f dB\n", error);
  EXPECT_LT(error, -110);
}

// Moments or not, by 64 frames or by 128: a jump between the ways would show against the one that never changes.
TEST(MixerSum, TheMixerChangesBetweenTablesAndMomentsWithoutAJump) {
  const Scene scene(30, 50, 200, 40000);
  const auto by_128 = scene.play(96000, 128), by_64 = scene.play(96000, 64), by_17 = scene.play(96000, 17);
  for (const auto* other : {&by_64, &by_17}) {
    for (std::size_t first = 0; first < 96000; first += 4000) {
      double loudest = 0, worst = 0;
      for (std::size_t n = first; n < first + 4000; ++n) {
        loudest = std::max(loudest, std::abs(by_128->left[n]));
        worst = std::max(worst, std::abs(by_128->left[n] - (*other)->left[n]));
      }
      EXPECT_LT(worst, 2e-6 * loudest + 2e-6) << "frames from " << first;
    }
  }
}

TEST(MixerSum, GainsMoveWhileManyModesRing) {
  const Scene scene(20, 100, 20, 0);
  auto still = scene.play(2000, 128), moved = scene.play(2000, 128);
  moved->push(gain_at(2500, 3, 0, 0.02));
  moved->push(gain_at(6000, 3, scene.gain[3], 0.02));
  still->render(8000, 128);
  moved->render(8000, 128);
  const auto difference = [&](std::size_t from, std::size_t to) {
    double worst = 0;
    for (std::size_t n = from; n < to; ++n) worst = std::max(worst, std::abs(still->left[n] - moved->left[n]));
    return worst;
  };
  const double loudest = peak(still->left_from(2500));
  EXPECT_LT(difference(0, 2500), 2e-6 * peak(still->left));
  EXPECT_GT(difference(3600, 6000), 1e-3 * loudest);
  EXPECT_LT(difference(7200, 10000), 2e-6 * loudest);
  EXPECT_LT(largest_step(moved->left, 2490, 3600), 1.5 * largest_step(still->left, 2490, 3600));
}

TEST(MixerSum, AModeThatWentToRestComesBackWhenStruck) {
  Player player;
  Bank bank = random_bank(3, 400, kPoints);
  for (double& decay : bank.decay_per_s) decay = 30;
  player.install(0, map_of(bank));
  player.push(vertex_strike_at(0, 0, 1, {1, 1, 1}));
  player.render(128 * 20);
  const auto ringing = player.mixer.counters().ringing_modes.load();
  EXPECT_GT(ringing, 300u);
  player.render(48000);
  EXPECT_EQ(player.mixer.counters().ringing_modes, 0u);
  EXPECT_EQ(peak(player.left_from(player.left.size() - 100)), 0);
  player.push(vertex_strike_at(60000, 0, 1, {1, 1, 1}));
  player.render(60000 + 128 * 20 - player.left.size());
  EXPECT_EQ(player.mixer.counters().ringing_modes, ringing);
  const double loudest = peak(player.left);
  for (std::size_t n = 0; n < 2000; ++n) ASSERT_NEAR(player.left[60000 + n], player.left[n], 1e-6 * loudest);
}

TEST(MixerSum, ModesRestOnceTheyAreBelowTheFloor) {
  std::vector<std::uint32_t> ringing[2];
  for (int quick = 0; quick < 2; ++quick) {
    Player player;
    if (quick == 1) set(player.mixer, &MixerSettings::floor_db, 60);
    player.install(0, map_of(random_bank(3, 400, kPoints)));
    player.push(vertex_strike_at(0, 0, 1, {0.1, 0.1, 0.1}));
    for (int second = 0; second < 12; ++second) {
      player.render(48000);
      ringing[quick].push_back(player.mixer.counters().ringing_modes);
    }
    EXPECT_TRUE(std::ranges::is_sorted(ringing[quick], std::greater<>()));
    EXPECT_EQ(ringing[quick].back(), 0u);
  }
  for (std::size_t second = 0; second < 4; ++second) EXPECT_LT(ringing[1][second], ringing[0][second]);
}

TEST(MixerSum, AnObjectThatBecomesInfiniteLeavesTheOthersAlone) {
  const Scene scene(40, 50, 40, 0);
  auto clean = scene.play(1000, 128), poisoned = scene.play(1000, 128);
  for (Player* player : {clean.get(), poisoned.get()}) {
    player->push(strike_at(1500, 40, {0, 0, 1}));
    player->install(40, map_of(random_bank(99, 50, kPoints)));
  }
  poisoned->push(vertex_strike_at(1200, 40, 3, {1e300, 0, 0}));
  clean->render(3000, 128);
  poisoned->render(3000, 128);
  EXPECT_GE(poisoned->mixer.counters().not_finite, 1u);
  const double loudest = peak(clean->left);
  for (std::size_t n = 0; n < clean->left.size(); ++n) {
    ASSERT_NEAR(poisoned->left[n], clean->left[n], 1e-6 * loudest) << n;
  }
}

}  // namespace
}  // namespace ringdown::synth::test
