// Muted modes: what is left out goes and comes without a click, and nothing that was played meanwhile is lost.
#include "engine/synth/modes/voice.h"
#include "tests/synth/player.h"

#include <array>
#include <limits>

namespace ringdown::synth::test {
namespace {

constexpr Level kAll = kNoThreshold, kNone = 100000;
constexpr double kFloor = 1e-9;

// Two voices of one bank. Whatever happens, happens to both, but modes are muted in the first one only.
class Pair {
 public:
  Pair() : table_(std::make_shared<ModeTable>(map_of(random_bank(3, 200, 5)), modal::MaterialScale{}, kRate)) {
    for (auto& voice : voices_) voice = std::make_unique<Voice>(table_);
  }
  Voice& muted() { return *voices_[0]; }
  Voice& whole() { return *voices_[1]; }

  void strike(double impulse_ns) {
    for (auto& voice : voices_) ASSERT_TRUE(voice->strike(verb::StrikeVertex{1, {0, impulse_ns, 0}, 0}));
  }
  // In the middle of a chunk of which `frames_left` remain.
  void strike_late(double impulse_ns, std::size_t frames_left) {
    for (auto& voice : voices_) {
      std::array<double, kChunkFrames> ignored{};
      ASSERT_TRUE(voice->strike_late(verb::StrikeVertex{1, {0, impulse_ns, 0}, 0}, frames_left));
      ASSERT_TRUE(voice->render_late(ignored.data(), frames_left));
      voice->merge_late();
    }
  }
  // Mutes what lies below the threshold, and brings back at most `allowance` modes of what lies above.
  void apply(Level threshold, std::size_t allowance = std::numeric_limits<std::size_t>::max()) {
    muted().set_threshold(threshold);
    muted().apply_threshold(allowance, false);
  }
  // Renders some chunks by tables; returns the samples of the muted voice and of the whole one.
  std::array<Samples, 2> render(int chunks) {
    std::array<Samples, 2> samples;
    for (std::size_t v = 0; v < 2; ++v) {
      for (int chunk = 0; chunk < chunks; ++chunk) {
        std::array<double, kChunkFrames> out{};
        EXPECT_TRUE(voices_[v]->render(out.data(), kChunkFrames, kFloor));
        samples[v].insert(samples[v].end(), out.begin(), out.end());
      }
    }
    return samples;
  }

 private:
  std::shared_ptr<ModeTable> table_;
  std::array<std::unique_ptr<Voice>, 2> voices_;
};

TEST(MutedModes, MutedModesComeBackAsIfTheyHadNeverLeft) {
  Pair pair;
  pair.strike(1);
  pair.render(3);
  pair.apply(kNone);
  const auto leaving = pair.render(1);
  EXPECT_GT(peak(leaving[0]), 0) << "they leave by a ramp";
  EXPECT_EQ(peak(pair.render(100)[0]), 0);
  EXPECT_GT(pair.muted().counts().muted, 150u);
  pair.apply(kAll);
  pair.render(1);
  EXPECT_EQ(pair.muted().counts().muted, 0u);
  const auto [muted, whole] = pair.render(10);
  EXPECT_LT(relative_error_db(muted, whole), -120);
}

TEST(MutedModes, MutedModesKeepTheStrikesThatComeMeanwhile) {
  Pair pair;
  pair.strike(1);
  pair.render(3);
  pair.apply(kNone);
  pair.render(5);
  for (int i = 0; i < 4; ++i) {
    pair.strike(0.3);
    pair.render(2);
    pair.strike_late(0.2, 64);
    pair.render(1);
  }
  EXPECT_GT(pair.muted().counts().muted, 150u);
  pair.apply(kAll);
  pair.render(1);
  const auto [muted, whole] = pair.render(10);
  EXPECT_LT(relative_error_db(muted, whole), -120);
}

TEST(MutedModes, MutedModesAreBroughtBackByAStrikeThatIsLoudEnough) {
  Pair pair;
  pair.strike(1e-4);
  pair.render(1);
  const Level above_all = level_of(1e-4);
  pair.apply(above_all);
  pair.render(2);
  EXPECT_EQ(pair.muted().counts().sounding, pair.muted().counts().sounding - pair.muted().counts().slow)
      << "all that can be muted is";
  pair.strike(1e4);
  EXPECT_GT(pair.muted().counts().slow, 150u);
  const auto [muted, whole] = pair.render(5);
  EXPECT_LT(relative_error_db(muted, whole), -60);
}

TEST(MutedModes, MutedModesReturnNoFasterThanIsAllowed) {
  Pair pair;
  pair.strike(1);
  pair.apply(kNone);
  pair.render(2);
  const std::size_t before = pair.muted().counts().muted;
  pair.apply(kAll, 40);
  pair.render(1);
  EXPECT_EQ(pair.muted().counts().muted, before - 40);
}

TEST(MutedModes, MutedModesLeaveAndEnterWithoutAStep) {
  Pair pair;
  pair.strike(1);
  Samples muted, whole;
  for (int round = 0; round < 6; ++round) {
    pair.apply(round % 2 == 0 ? kNone : kAll);
    const auto samples = pair.render(4);
    muted.insert(muted.end(), samples[0].begin(), samples[0].end());
    whole.insert(whole.end(), samples[1].begin(), samples[1].end());
  }
  const double ramp = 2 * peak(whole) / kChunkFrames;  // what the ramp may add to a step
  EXPECT_LT(largest_step(muted, 1, muted.size()), largest_step(whole, 1, whole.size()) + ramp);
}

TEST(MutedModes, MutedModesRestOnceTheyHaveDiedAway) {
  Pair pair;
  pair.strike(1e-6);
  pair.apply(kNone);
  pair.render(1);
  ASSERT_GT(pair.muted().counts().muted, 150u);
  pair.render(3000);
  LevelHistogram histogram;
  pair.muted().count_levels(histogram, 0, 1.0);
  EXPECT_EQ(pair.muted().counts().muted, 0u) << "below the floor";
  EXPECT_FALSE(pair.muted().ringing());
}

}  // namespace
}  // namespace ringdown::synth::test
