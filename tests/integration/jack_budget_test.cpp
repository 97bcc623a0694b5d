// The time budget under a real deadline: jackd with real-time scheduling, and a scene that takes four times the time
// there is.
#include "engine/modal/bank_file.h"
#include "tests/integration/jack_fixture.h"
#include "tests/support/pauses.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

namespace ringdown::test {
namespace {

using namespace std::chrono_literals;

constexpr int kRate = 192000, kPeriod = 128;
constexpr std::size_t kModes = 2000, kObjectsToMeasure = 20, kMaxObjects = 500;
constexpr double kLoad = 2.5;    // in proportion to that of a few objects, which caches hold; in truth about four
constexpr int kFewMisses = 5;    // of 4500 callbacks
constexpr int kFewModes = 1000;  // of those that there is time for
constexpr int kTries = 5;

class JackBudget : public testing::Test {
 protected:
  void SetUp() override {
#ifdef RINGDOWN_SANITIZE
    GTEST_SKIP() << "a load is what it is only without a sanitizer";
#endif
    if (!installed("jackd")) GTEST_SKIP() << "needs jackd2 (./run packages)";
    for (int tries = 0; !server_.runs(); ++tries) {
      if (tries == 2) GTEST_SKIP() << "needs a jackd with real-time scheduling, which does not start here";
      server_.stop();
      server_.start(kRate, kPeriod);
    }
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      modal::Bank bank = random_bank(seed, kModes, 8);
      for (double& decay_per_s : bank.decay_per_s) decay_per_s = 0.01;
      banks_.push_back(std::make_shared<const modal::Bank>(std::move(bank)));
    }
  }

  static std::string name(std::size_t object) { return "object" + std::to_string(object); }

  // A file of its own for each, so that they do not share their states.
  std::vector<std::string> arguments(std::size_t objects, int budget) {
    std::vector<std::string> all{"--connect", "--budget", std::to_string(budget)};
    for (std::size_t i = 0; i < objects; ++i) {
      const auto file = folder_ / (name(i) + ".glb");
      if (!exists(file)) {
        EXPECT_TRUE(modal::write_bank(*banks_[i % kSeeds], file));
      }
      all.insert(all.end(), {"--object", name(i) + "=" + file.string()});
    }
    return all;
  }

  struct Figures {
    double load = 0, p99 = 0;
    int misses = 0, xruns = 0, own_xruns = 0, hidden = 0, shed = 0;
    int sounding = 0, usually_sounding = 0, least_sounding = 0;  // modes: at last, and of more than a hundred looks
    std::uint64_t pauses = 0;                                    // of the machine
  };

  // Strikes all objects, and measures for some seconds from when they sound while some are struck again. Nothing when
  // that takes too long.
  std::optional<Figures> play(std::size_t objects, int budget) {
    Daemon daemon(arguments(objects, budget), server_.environment());
    if (!daemon.ready()) {
      EXPECT_FALSE(daemon.process().wait(0ms)) << daemon.process().output();
      return std::nullopt;
    }
    for (std::size_t i = 0; i < objects; ++i) {
      daemon.send(JackTest::strike(name(i), 0.1 * std::pow(10.0, -static_cast<double>(i % 30) / 20)));
      if (i % 10 == 9) std::this_thread::sleep_for(5ms);
    }
    std::optional<protocol::StatusReply> before, now;
    const bool all = becomes_true([&] {
      now = JackTest::status(daemon);
      return now && now->sounding_modes + now->hidden_modes >= static_cast<int>(objects * kModes * 9 / 10);
    });
    if (!all) {
      ADD_FAILURE() << "not all sounds: " << (now ? now->sounding_modes : -1) << " and hidden "
                    << (now ? now->hidden_modes : -1);
      return std::nullopt;
    }
    std::this_thread::sleep_for(1500ms);  // the mean load is of about a second
    before = JackTest::status(daemon);
    const std::uint64_t pauses = pauses_.count();
    const auto begin = std::chrono::steady_clock::now();
    std::vector<int> sounding;
    for (std::size_t i = 0; before && now && std::chrono::steady_clock::now() - begin < 3s; ++i) {
      daemon.send(JackTest::strike(name(i % objects), 0.01));
      std::this_thread::sleep_for(20ms);
      now = JackTest::status(daemon);
      if (now) sounding.push_back(now->sounding_modes);
    }
    if (!before || !now) {
      if (budget > 0) ADD_FAILURE() << "a daemon that keeps to its time does not answer";
      return std::nullopt;
    }
    std::ranges::sort(sounding);
    Figures figures{.load = now->load_mean, .p99 = now->load_p99};
    figures.misses = now->misses - before->misses;
    figures.xruns = now->xruns - before->xruns;
    figures.own_xruns = now->own_xruns - before->own_xruns;
    figures.least_sounding = sounding.front();
    figures.usually_sounding = sounding[sounding.size() / 2];
    figures.sounding = now->sounding_modes;
    figures.hidden = now->hidden_modes;
    figures.shed = now->shed - before->shed;
    figures.pauses = pauses_.count() - pauses;
    std::printf(
        "%zu objects, budget %d %%: load %.2f mean %.2f p99, %d callbacks late, %d xruns, %d of them ours, "
        "%d modes sound mostly, %d at least, %d are left out, shed %d; the machine paused %d times\n",
        objects, budget, figures.load, figures.p99, figures.misses, figures.xruns, figures.own_xruns,
        figures.usually_sounding, figures.least_sounding, figures.hidden, figures.shed,
        static_cast<int>(figures.pauses));
    return figures;
  }

  static constexpr std::uint32_t kSeeds = 8;
  // Plays until the machine did not pause meanwhile, which makes callbacks late whatever the mixer does; what happened
  // then counts, good or bad. Nothing when it always paused.
  std::optional<Figures> play_undisturbed(std::size_t objects, int budget) {
    for (int tries = 0; tries < kTries; ++tries) {
      const auto figures = play(objects, budget);
      if (figures && figures->pauses == 0) return figures;
    }
    return std::nullopt;
  }

  Pauses pauses_;
  TemporaryFolder folder_;
  JackServer server_{kRate, kPeriod, JackServer::Scheduling::realtime};
  std::vector<std::shared_ptr<const modal::Bank>> banks_;
};

// A scene that leaves most of the time unused says how much the machine disturbs an audio thread meanwhile.
TEST_F(JackBudget, KeepsTheTimeWhereAnUnboundedMixerMissesMost) {
  const auto few = play(kObjectsToMeasure, 0);
  if (!few) GTEST_SKIP() << "the machine stands still";
  const auto objects = static_cast<std::size_t>(std::ceil(kLoad / few->load * kObjectsToMeasure));
  if (objects > kMaxObjects) GTEST_SKIP() << "this machine is so fast that it would take " << objects << " objects";
  const auto without = play(objects, 0), with = play_undisturbed(objects, 70);
  if (!without) GTEST_SKIP() << "the machine stands still when it has too much to do";
  if (!with) GTEST_SKIP() << "the machine paused in each of " << kTries << " tries";
  if (few->misses > kFewMisses) GTEST_SKIP() << few->misses << " callbacks are late that have hardly anything to do";
  EXPECT_GT(without->p99, 1.5);
  EXPECT_GT(without->misses, 100);
  EXPECT_LE(with->misses, kFewMisses + without->misses / 50);
  EXPECT_LE(with->own_xruns, kFewMisses + without->own_xruns / 50);
  EXPECT_GT(with->sounding, 0);
  EXPECT_GT(with->usually_sounding, kFewModes);
  EXPECT_GT(with->hidden, 0);
}

}  // namespace
}  // namespace ringdown::test
