// Every event at its own frame, and the same sound however time is cut into blocks.
#include "tests/support/keep_signals.h"
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <random>

namespace ringdown::synth::test {
namespace {

// First frame whose sample is not zero. A strike's first sample is sin 0 = 0, so the sound begins one frame later.
std::size_t onset(const Samples& samples) {
  return static_cast<std::size_t>(std::find_if(samples.begin(), samples.end(), [](double s) { return s != 0; }) -
                                  samples.begin());
}

TEST(MixerTime, AStrikeSoundsFromItsOwnFrame) {
  for (const Frame frame : {0, 1, 63, 64, 65, 255, 256, 257, 1000}) {
    Player player;
    player.install(0, map_of(single_mode_bank(1000, 5)));
    player.push(strike_at(frame, 0, {0, 0, 1}));
    player.render(2048);
    EXPECT_EQ(onset(player.left), static_cast<std::size_t>(frame) + 1);
  }
}

TEST(MixerTime, TwoStrikesThreeMillisecondsApartStaySo) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 2000)));  // dies within the gap
  player.push(strike_at(1000, 0, {0, 0, 1}));
  player.push(strike_at(1144, 0, {0, 0, 1}));
  player.render(4096, 1024);
  const Samples once = closed_form(1000, 2000, 1, 0, kRate, 3096);
  for (std::size_t n = 0; n < once.size(); ++n) {
    ASSERT_NEAR(player.left[1000 + n], once[n] + (n < 144 ? 0 : once[n - 144]), 3e-6) << n;
  }
}

TEST(MixerTime, EventsPushedOutOfOrderPlayInOrder) {
  Player forwards, backwards;
  std::vector<Event> events;
  for (int i = 0; i < 20; ++i) events.push_back(strike_at(37 * i, 0, {0, 0, 0.1 * (i + 1)}));
  for (Player* player : {&forwards, &backwards}) player->install(0, map_of(single_mode_bank(1000, 50)));
  for (const Event& event : events) forwards.push(event);
  for (auto event = events.rbegin(); event != events.rend(); ++event) backwards.push(*event);
  forwards.render(2000);
  backwards.render(2000);
  EXPECT_EQ(forwards.left, backwards.left);
}

// Strike and then clear leaves a fade; clear and then strike leaves the strike.
TEST(MixerTime, EventsOfOneFrameHappenInTheOrderTheyWerePushed) {
  Player kept, faded;
  for (Player* player : {&kept, &faded}) player->install(0, map_of(single_mode_bank(1000, 1)));
  kept.push(clear_at(100, 0));
  kept.push(strike_at(100, 0, {0, 0, 1}));
  faded.push(strike_at(100, 0, {0, 0, 1}));
  faded.push(clear_at(100, 0));
  kept.render(2000);
  faded.render(2000);
  EXPECT_GT(peak(kept.left_from(1000)), 0.1);
  EXPECT_EQ(peak(faded.left_from(1000)), 0);
}

TEST(MixerTime, ALateEventPlaysAtOnceAndIsCounted) {
  Player player;
  player.install(0, map_of(single_mode_bank(1000, 5)));
  player.render(1000);
  EXPECT_EQ(player.mixer.counters().late, 0u);
  player.push(strike_at(999, 0, {0, 0, 1}));
  player.push(gain_at(-5, 0, 1));
  player.render(1000);
  EXPECT_EQ(onset(player.left), 1001u);
  EXPECT_EQ(player.mixer.counters().late, 2u);
  player.push(strike_at(2000, 0, {0, 0, 1}));
  player.render(64);
  EXPECT_EQ(player.mixer.counters().late, 2u) << "the frame that comes next is not late";
}

TEST(MixerTime, TheMixerCountsFrames) {
  Player player;
  player.render(777, 100);
  EXPECT_EQ(player.mixer.counters().frames, 777);
  player.mixer.render({}, {});
  EXPECT_EQ(player.mixer.counters().frames, 777);
}

// A whole performance: three objects, strikes, ramps, a clear, a swap, a retune and a removal, each at its frame.
class Performance {
 public:
  Performance() {
    std::mt19937 random(11);
    const auto uniform = [&random](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
    };
    for (int i = 0; i < 60; ++i) {
      const auto frame = static_cast<Frame>(uniform(0, 30000));
      const auto object = static_cast<ObjectNumber>(i % 3);
      events_.push_back(strike_at(frame, object, {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}, uniform(0, 2e-3),
                                  {uniform(-0.1, 0.1), uniform(-0.1, 0.1), uniform(-0.1, 0.1)}));
      if (i % 5 == 0) events_.push_back(gain_at(frame + 300, object, uniform(0, 2), uniform(0, 0.2)));
      if (i % 7 == 0) events_.push_back(pan_at(frame + 500, object, uniform(-1, 1)));
    }
    events_.push_back(clear_at(20001, 1));
    for (std::uint32_t seed = 0; seed < 4; ++seed) maps_.push_back(map_of(random_bank(20 + seed, 45, 40)));
    at_frame_ = {
        {0,
         [this](Player& p) {
           for (ObjectNumber o = 0; o < 3; ++o) p.install(o, maps_[o]);
         }},
        {10007, [this](Player& p) { p.install(0, maps_[3]); }},
        {15000, [this](Player& p) { p.install(1, maps_[1], Mixer::Install::retune, {.alpha = 2, .stiffness = 1.2}); }},
        {25001, [](Player& p) { ASSERT_TRUE(p.mixer.remove(2)); }}};
  }

  // Renders 40000 frames in blocks of the given sizes, over and over; a block ends where a bank changes.
  [[nodiscard]] Samples play(const std::vector<std::size_t>& blocks) const {
    Player player;
    for (const Event& event : events_) player.push(event);
    std::size_t next_action = 0, i = 0;
    while (player.left.size() < 40000) {
      const std::size_t now = player.left.size();
      for (; next_action < at_frame_.size() && at_frame_[next_action].first == now; ++next_action) {
        at_frame_[next_action].second(player);
      }
      const std::size_t stop = next_action < at_frame_.size() ? at_frame_[next_action].first : 40000;
      player.render(std::min(blocks[i++ % blocks.size()], stop - now), 8192);
    }
    Samples both = player.left;
    both.insert(both.end(), player.right.begin(), player.right.end());
    return both;
  }

 private:
  std::vector<Event> events_;
  std::vector<Map> maps_;
  std::vector<std::pair<std::size_t, std::function<void(Player&)>>> at_frame_;
};

TEST(MixerTime, BlockSizeDoesNotChangeTheSound) {
  const Performance performance;
  const Samples reference = performance.play({64});
  ASSERT_GT(peak(reference), 0.01);
  double worst = -400;
  for (const auto& blocks : std::vector<std::vector<std::size_t>>{{1},
                                                                  {2},
                                                                  {3},
                                                                  {17},
                                                                  {63},
                                                                  {65},
                                                                  {100},
                                                                  {128},
                                                                  {256},
                                                                  {441},
                                                                  {1000},
                                                                  {1024},
                                                                  {4096},
                                                                  {8192},
                                                                  {1, 8192, 64, 3, 511, 1025, 2}}) {
    const Samples other = performance.play(blocks);
    KeepSignals keep(kRate);
    keep.add("reference", reference);
    keep.add("block", other);
    const double error = relative_error_db(other, reference);
    worst = std::max(worst, error);
    EXPECT_LT(error, -100) << "blocks of " << blocks[0];
  }
  std::printf("block-size invariance, 1 to 8192 and changing: worst %.1f dB\n", worst);
}

TEST(MixerTime, RunsOfOneScoreAreBitIdentical) {
  const Performance performance;
  EXPECT_EQ(performance.play({441}), performance.play({441}));
}

}  // namespace
}  // namespace ringdown::synth::test
