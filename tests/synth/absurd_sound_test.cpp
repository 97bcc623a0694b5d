// Whatever a bank, an input or a contact holds, every sample at every output is finite, and the mixer plays on. There
// is no limiter, which would hide what the others let through.
#include "engine/synth/modes/coupled_modes.h"
#include "tests/synth/every_output.h"
#include "tests/synth/player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN(),
                kInfinite = std::numeric_limits<float>::infinity();

// Modes that bend the point they share, and stretch each other `stretching` times as hard as a plate of their
// thickness would.
modal::Bank bending_bank(double stretching, double curving = 0) {
  constexpr std::size_t kModes = 6;
  constexpr double kThickness_m = 1e-3;
  modal::Bank bank = single_mode_bank(200, 1);
  const std::size_t points = bank.point_count();
  modal::NonlinearTerms terms{.thickness_m = kThickness_m, .coupled = kModes};
  for (std::size_t m = 0; m < kModes; ++m) {
    if (m > 0) {
      bank.frequency_hz.push_back(200 * static_cast<double>(m + 1));
      bank.decay_per_s.push_back(1);
      bank.radiation->maps.modes.push_back(ringdown::test::even_field(bank.frequency_hz[m]));
      bank.shapes.insert(bank.shapes.end(), points, {0, 0, 1});
    }
    const double omega = 2 * std::numbers::pi * bank.frequency_hz[m];
    terms.modes.push_back(static_cast<std::uint32_t>(m));
    terms.curving.push_back(static_cast<float>(curving * omega));
    for (std::size_t j = 0; j <= m; ++j) {
      const double other = 2 * std::numbers::pi * bank.frequency_hz[j];
      terms.bending.push_back(static_cast<float>(stretching * std::sqrt(omega * other) / kThickness_m));
    }
  }
  bank.nonlinear = terms;
  return bank;
}

// A mixer with all its outputs, and two objects, each at a bus of its own: the one that is attacked, and a witness that
// rings on.
struct Attacked {
  Mixer mixer{kRate, {.ambisonic_order = 3}};
  EveryOutput outputs;
  std::size_t not_finite = 0;

  explicit Attacked(modal::Bank bank) {
    EXPECT_TRUE(mixer.install(0, std::make_unique<Voice>(mixer.table_for(map_of(std::move(bank)), {})),
                              Mixer::Install::replace));
    EXPECT_TRUE(mixer.install(1, std::make_unique<Voice>(mixer.table_for(map_of(single_mode_bank(440, 4)), {})),
                              Mixer::Install::replace));
    EXPECT_TRUE(mixer.assign(0, 0));
    EXPECT_TRUE(mixer.assign(1, 1));
  }
  void push(const Event& event) { EXPECT_TRUE(mixer.push(Producer::control, event)); }
  void render(std::size_t frames, const Inputs& inputs = {}) {
    for (constexpr std::size_t kBlock = 256; frames > 0; frames -= std::min(kBlock, frames)) {
      not_finite += outputs.render(mixer, std::min(kBlock, frames), inputs);
    }
  }
  // Whether all was finite, and the object can be heard again once the attack is over.
  void expect_unharmed() {
    push(clear_at(mixer.counters().frames, 0));
    push(clear_at(mixer.counters().frames, 1));
    render(4096);
    EXPECT_FALSE((outputs.take_loud(), render(512), outputs.take_loud()));
    push(strike_at(mixer.counters().frames, 0, {0, 0, 1e-6}));
    render(512);
    EXPECT_TRUE(outputs.take_loud()) << "the object plays again";
    EXPECT_EQ(not_finite, 0u);
  }
};

class Stretching : public testing::TestWithParam<double> {};

TEST_P(Stretching, TermsBeyondAnyBodyAreHeardNowhereAsNoNumber) {
  for (const double curving : {0.0, 0.5, 1e12}) {
    for (const double impulse_ns : {1e-3, 1.0, 1e4}) {
      SCOPED_TRACE(testing::Message() << "curving " << curving << ", " << impulse_ns << " N s");
      Attacked attacked(bending_bank(GetParam(), curving));
      attacked.push(strike_at(0, 0, {0, 0, impulse_ns}));
      attacked.push(strike_at(100, 1, {0, 0, 0.1}));
      attacked.render(4800);
      attacked.push(strike_at(attacked.mixer.counters().frames + 77, 0, {0, 0, impulse_ns}));
      attacked.push(gain_at(attacked.mixer.counters().frames + 78, 0, 100));
      attacked.render(4800);
      EXPECT_EQ(attacked.not_finite, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Powers, Stretching, testing::Values(1, 1e3, 1e6, 1e9, 1e12, 1e18, 1e24, 1e30));

TEST(AbsurdSound, CoupledModesThatLeaveTheNumbersAddNothingAndComeToRest) {
  const ModeTable table(map_of(bending_bank(1)), {}, kRate);
  ASSERT_TRUE(table.coupled);
  for (const double absurd : {1e13, 1e30, 1e200, 1e300, double{kInfinite}, double{kNotANumber}}) {
    CoupledModes modes(*table.coupled);
    std::vector<double> re(table.columns()), im(table.columns());
    im[table.coupled->columns[2]] = absurd;
    modes.take(re.data(), im.data());
    std::array<double, kChunkFrames> out{};
    EXPECT_FALSE(modes.render(out.data(), out.size())) << absurd;
    EXPECT_TRUE(std::all_of(out.begin(), out.end(), [](double sample) { return sample == 0; })) << absurd;
    EXPECT_FALSE(modes.running());
  }
}

TEST(AbsurdSound, ABankWhoseOutputIsHugeOrTinyStillGlidesInNumbers) {
  for (const double gain : {1e-300, 1e-30, 1e-12, 1e12, 1e30, 1e300}) {
    modal::Bank bank = bending_bank(1);
    bank.gain = gain;
    Attacked attacked(std::move(bank));
    for (const double impulse_ns : {1e-6, 1.0, 1e4}) {
      attacked.push(strike_at(attacked.mixer.counters().frames, 0, {0, 0, impulse_ns}));
      attacked.render(2560);
    }
    EXPECT_EQ(attacked.not_finite, 0u) << gain;
  }
}

TEST(AbsurdSound, AnInputThatIsNoSoundIsHeardNowhereAsNoNumber) {
  for (const float bad : {kNotANumber, kInfinite, -kInfinite, std::numeric_limits<float>::max(), 1e30F}) {
    SCOPED_TRACE(bad);
    Attacked attacked(bending_bank(1));
    ASSERT_TRUE(attacked.mixer.connect_input(0, 0, {1, 1, 1}, {0, 0, 1e6}));
    std::vector<float> samples(256);
    attacked.push(strike_at(0, 1, {0, 0, 0.1}));
    attacked.render(512, {samples.data()});
    samples[100] = bad;
    attacked.render(256, {samples.data()});
    samples[100] = 0;
    attacked.render(2560, {samples.data()});
    EXPECT_GT(attacked.mixer.counters().not_finite, 0u);
    attacked.expect_unharmed();
  }
}

// A force of this size lasts for a chunk in which a fast mode dies: neither its state nor its energy tells.
TEST(AbsurdSound, AHugeForceOnModesThatDieAtOnceIsFoundByItsSamples) {
  Attacked attacked(single_mode_bank(440, 3e4));
  ASSERT_TRUE(attacked.mixer.connect_input(0, 0, {1, 1, 1}, {0, 0, 1e6}));
  std::vector<float> samples(256);
  samples[130] = 1e36F;
  attacked.render(256, {samples.data()});
  EXPECT_GT(attacked.mixer.counters().not_finite, 0u);
  samples[130] = 0;
  attacked.expect_unharmed();
}

TEST(AbsurdSound, AMalletOnABankThatHardlyWeighsAnythingIsHeardNowhereAsNoNumber) {
  for (const float size : {1e-20F, 1e6F, 1e12F, 1e18F, 1e30F, 1e38F}) {
    SCOPED_TRACE(size);
    Attacked attacked(single_mode_bank(440, 4, {0, 0, size}));
    attacked.push({0, 0, verb::Mallet{{1, 1, 1}, {0, 0, -1000}, 1000, 1e14, 1}});
    attacked.render(4800);
    const verb::Bow bow{.point_m = {1, 1, 1}, .direction = {0, 0, 1}, .speed_m_s = 100, .force_n = 1e5, .rosin = 5};
    attacked.push({attacked.mixer.counters().frames, 0, bow});
    attacked.render(4800);
    EXPECT_EQ(attacked.not_finite, 0u);
  }
}

TEST(AbsurdSound, AClickOfABodyWithoutWeightIsHeardNowhereAsNoNumber) {
  for (const double mass_kg : {1e-300, 1e-30, 1e-9}) {
    modal::Bank bank = single_mode_bank(440, 4);
    bank.mass = modal::MassProperties{.mass_kg = mass_kg, .inertia_kg_m2 = {mass_kg, mass_kg, mass_kg}};
    Attacked attacked(std::move(bank));
    attacked.push({.frame = 0, .object = 0, .verb = verb::Click{.impulse_ns = {0, 0, 1e9}, .contact_time_s = 0}});
    attacked.render(4800);
    EXPECT_EQ(attacked.not_finite, 0u) << mass_kg;
  }
}

// The responses of a head may be any floats. What they make of a sound that is loud, but no fault, passes no number on.
TEST(AbsurdSound, AHeadOfHugeResponsesIsHeardAsSilenceAndCounted) {
  auto filters = std::make_shared<HeadFilters>();
  filters->taps = 4;
  for (auto& ear : filters->reversed) ear.assign(kMaxAmbisonicChannels * filters->taps, 3e38F);
  Mixer mixer(kRate, {.head = [&](double) { return filters; }});
  ASSERT_TRUE(mixer.install(0, std::make_unique<Voice>(mixer.table_for(map_of(single_mode_bank(440, 4)), {})),
                            Mixer::Install::replace));
  ASSERT_TRUE(mixer.push(Producer::control, strike_at(0, 0, {0, 0, 1e6})));
  EveryOutput outputs;
  std::size_t not_finite = 0;
  for (int block = 0; block < 20; ++block) not_finite += outputs.render(mixer, 256);
  EXPECT_EQ(not_finite, 0u);
  EXPECT_GT(mixer.counters().not_finite, 0u);
}

}  // namespace
}  // namespace ringdown::synth::test
