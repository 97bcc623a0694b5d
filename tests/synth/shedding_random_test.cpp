// Scores at random under a time budget: nothing that was played gets lost, whatever was left out meanwhile.
#include "tests/synth/fake_clock.h"
#include "tests/synth/player.h"

#include <cstdio>
#include <random>

namespace ringdown::synth::test {
namespace {

constexpr std::size_t kFrames = 128;
constexpr double kPeriod_ns = kFrames * 1e9 / kRate;

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
    set(player.mixer, &MixerSettings::clock, kFake);
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
    set(player.mixer, &MixerSettings::budget, share);
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
      player.push(pan_at(frame, any(), 0.1 * below(9) - 0.4));
    }
    if (below(40) == 0) install(any());
  }

  std::mt19937 random_;
  std::uint32_t kinds_, objects_;
  std::size_t modes_;
  std::vector<std::shared_ptr<ModeTable>> tables_;
};

TEST(SheddingAtRandom, SheddingLosesNoStrikeAndPlaysNoneTwice) {
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
      EXPECT_EQ(score.counters().muted_modes.load(), 0u) << "score " << seed;
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

}  // namespace
}  // namespace ringdown::synth::test
