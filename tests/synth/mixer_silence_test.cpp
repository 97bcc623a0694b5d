// Objects that are silenced: nothing of them is heard at any output, nothing clicks, and nothing else changes.
#include "tests/synth/player.h"

#include <algorithm>

namespace ringdown::synth::test {
namespace {

constexpr auto kRamp = static_cast<std::size_t>(Mixer::kSilenceRamp_s * kRate);
constexpr std::size_t kSilencedAt = 4096, kHeardAt = 12288, kEnd = 24576;

// Objects 0 and 1 ring, and object 0 is silenced for a while, or never.
class Pair {
 public:
  // With `shared` both have voices of one table, which share their states (InstanceGroup).
  explicit Pair(std::size_t modes, bool shared) {
    const Map map = map_of(random_bank(1, modes, 3));
    const Map other = shared ? map : map_of(random_bank(2, modes, 3));
    const auto table = player_.mixer.table_for(map, {}), other_table = player_.mixer.table_for(other, {});
    for (const auto& [object, voices] : {std::pair(0u, table), {1u, other_table}}) {
      EXPECT_TRUE(player_.mixer.install(object, std::make_unique<Voice>(voices), Mixer::Install::replace));
      EXPECT_TRUE(player_.mixer.assign(object, object));
    }
    player_.push(gain_at(0, 0, 0.5));
    player_.push(vertex_strike_at(600, 0, 1, {100, 200, 300}));
    player_.push(vertex_strike_at(700, 1, 1, {300, 100, 200}));
  }

  void render_to(std::size_t end) {
    for (std::size_t at = mix_.size(); at < end; at += kBlock) {
      std::vector<float> left(kBlock), right(kBlock), first(kBlock), second(kBlock);
      Outputs outputs(left.data(), right.data());
      outputs.listen_to_bus(0, first.data());
      outputs.listen_to_bus(1, second.data());
      player_.mixer.render(outputs, kBlock);
      mix_.insert(mix_.end(), left.begin(), left.end());
      first_.insert(first_.end(), first.begin(), first.end());
      second_.insert(second_.end(), second.begin(), second.end());
    }
  }
  void silence(bool silent) { EXPECT_TRUE(player_.mixer.silence(0, silent)); }

  Player player_;
  Samples mix_, first_, second_;

 private:
  static constexpr std::size_t kBlock = 256;
};

struct Case {
  std::size_t modes;
  bool shared;
};
class Silence : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(AloneAndInAGroup, Silence,
                         testing::Values(Case{5, false}, Case{300, false}, Case{5, true}, Case{300, true}));

double max_difference(const Samples& a, const Samples& b, std::size_t begin, std::size_t end) {
  double max = 0;
  for (std::size_t n = begin; n < end; ++n) max = std::max(max, std::abs(a[n] - b[n]));
  return max;
}

TEST_P(Silence, ASilencedObjectIsAbsentEverywhereAndComesBackAsIfItHadBeenHeard) {
  Pair plain(GetParam().modes, GetParam().shared), silenced(GetParam().modes, GetParam().shared);
  plain.render_to(kEnd);
  silenced.render_to(kSilencedAt);
  silenced.silence(true);
  silenced.render_to(kHeardAt);
  silenced.silence(false);
  silenced.render_to(kEnd);

  const double loud = peak(plain.first_);
  ASSERT_GT(loud, 1e-3);
  EXPECT_EQ(max_difference(plain.mix_, silenced.mix_, 0, kSilencedAt), 0) << "bit for bit until then";
  for (std::size_t n = kSilencedAt + kRamp + 1; n < kHeardAt; ++n) {
    ASSERT_NEAR(silenced.first_[n], 0, 2e-6 * loud) << n;  // what moments lend one output of its neighbour
    ASSERT_NEAR(silenced.mix_[n], std::sqrt(0.5) * silenced.second_[n], 1e-5 * loud) << n;
  }
  EXPECT_LT(max_difference(plain.second_, silenced.second_, 0, kEnd), 1e-5 * loud) << "the other does not notice";
  EXPECT_LT(max_difference(plain.first_, silenced.first_, kHeardAt + kRamp + 1, kEnd), 1e-5 * loud);
}

TEST_P(Silence, BothWaysAreStraightRampsOfTheGain) {
  Pair plain(GetParam().modes, GetParam().shared), silenced(GetParam().modes, GetParam().shared);
  plain.render_to(kEnd);
  silenced.render_to(kSilencedAt);
  silenced.silence(true);
  silenced.render_to(kHeardAt);
  silenced.silence(false);
  silenced.render_to(kEnd);
  const double loud = peak(plain.first_);
  for (std::size_t n = 0; n < kRamp; ++n) {
    const double share = static_cast<double>(n) / static_cast<double>(kRamp);
    ASSERT_NEAR(silenced.first_[kSilencedAt + n], (1 - share) * plain.first_[kSilencedAt + n], 1e-5 * loud) << n;
    ASSERT_NEAR(silenced.first_[kHeardAt + n], share * plain.first_[kHeardAt + n], 1e-5 * loud) << n;
  }
}

TEST(Silence, AGainThatIsSetMeanwhileCountsAfterwards) {
  Player player;
  player.install(0, map_of(random_bank(1, 20, 1)));
  player.push(vertex_strike_at(0, 0, 1, {100, 200, 300}));
  player.render(2560);
  ASSERT_TRUE(player.mixer.silence(0, true));
  player.render(2560);
  player.push(gain_at(0, 0, 0.25));
  player.render(2560);
  EXPECT_EQ(peak(player.left_from(5120)), 0);
  ASSERT_TRUE(player.mixer.silence(0, false));
  player.render(2560);

  Player plain;
  plain.install(0, map_of(random_bank(1, 20, 1)));
  plain.push(vertex_strike_at(0, 0, 1, {100, 200, 300}));
  plain.render(4 * 2560);
  for (std::size_t n = 7680 + kRamp + 1; n < 4 * 2560; ++n)
    ASSERT_NEAR(player.left[n], 0.25 * plain.left[n], 1e-6) << n;
}

TEST(Silence, AnObjectThatIsSilencedBeforeItHasAVoiceNeverSounds) {
  Player player;
  ASSERT_TRUE(player.mixer.silence(0, true));
  player.install(0, map_of(random_bank(1, 20, 1)));
  player.push(vertex_strike_at(0, 0, 1, {100, 200, 300}));
  player.push({.frame = 100, .object = 0, .verb = verb::Click{.impulse_ns = {1, 0, 0}, .contact_time_s = 1e-3}});
  player.render(4800);
  EXPECT_EQ(peak(player.left), 0);
}

}  // namespace
}  // namespace ringdown::synth::test
