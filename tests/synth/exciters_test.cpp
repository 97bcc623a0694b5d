// Forces that last: contact pulses played sample by sample, and inputs that excite objects.
#include "tests/synth/mode_bundle.h"
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <hwy/targets.h>

#include <algorithm>
#include <complex>
#include <limits>
#include <random>

namespace ringdown::synth::test {
namespace {

// A mode under a half-sine of unit impulse that begins at 0, t in seconds: the convolution of the pulse with
// exp(-d t) sin(omega t), by the exponential's antiderivative.
long double under_half_sine(long double f, long double d, long double tau, long double t) {
  using Complex = std::complex<long double>;
  const long double pi = std::numbers::pi_v<long double>, turn = pi / tau, u = std::min(t, tau);
  const Complex s(-d, 2 * pi * f);
  const auto antiderivative = [&](long double x) {
    return std::exp(s * (t - x)) * (-s * std::sin(turn * x) - turn * std::cos(turn * x)) / (s * s + turn * turn);
  };
  return turn / 2 * (antiderivative(u) - antiderivative(0)).imag();
}

double largest(std::span<const double> samples) {
  double max = 0;
  for (const double sample : samples) max = std::max(max, std::abs(sample));
  return max;
}

double largest_difference(std::span<const double> a, std::span<const double> b) {
  double max = 0;
  for (std::size_t n = 0; n < a.size(); ++n) max = std::max(max, std::abs(a[n] - b[n]));
  return max;
}

TEST(ContactPulse, AContactPulsePlayedSampleBySampleIsTheConvolutionWithTheMode) {
  for (const double f : {90.0, 440.0, 3000.0}) {
    for (const double tau : {0.001, 0.0051, 0.02}) {
      Player player;
      set(player.mixer, &MixerSettings::exact_contacts, true);
      player.install(0, map_of(single_mode_bank(f, 30)));
      player.push(strike_at(700, 0, {0, 0, 1}, tau));
      player.render(4800);
      const double scale = std::numbers::sqrt2 / 2 * ringdown::test::kLoudness * 2 * std::numbers::pi * f;
      Samples expected(player.left.size());
      for (std::size_t n = 700; n < expected.size(); ++n) {
        const long double t = static_cast<long double>(n - 700) / kRate;
        expected[n] = scale * static_cast<double>(under_half_sine(f, 30, tau, t));
      }
      // The pulse is sampled, so the convolution is its trapezoidal sum: Euler and Maclaurin's first term, at the
      // corners of the pulse and where the mode's response begins.
      const double pulse = 0.5 * std::numbers::pi / tau;
      const double first_term = pulse * (2 * std::numbers::pi / tau + 2 * std::numbers::pi * f) / (12 * kRate * kRate);
      EXPECT_LE(largest_difference(player.left, expected), (first_term + 1e-6) * scale) << f << " Hz, " << tau << " s";
      EXPECT_GT(largest(expected), 1e-3 * scale);
    }
  }
}

TEST(ContactPulse, AContactPulseIsTheSameOnEveryInstructionSet) {
  const auto play = [] {
    Player player;
    set(player.mixer, &MixerSettings::exact_contacts, true);
    player.install(0, map_of(random_bank(3, 203, 30)));
    player.push(strike_at(10, 0, {1, 0, 0}, 0.004));
    player.push(strike_at(50, 0, {0, 1, 0}, 0.004));
    player.render(1000, 200);
    return player.left;
  };
  const Samples reference = play();
  for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1) {
    hwy::SetSupportedTargetsForTest(rest & -rest);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_LE(largest_difference(play(), reference), 2e-6 * largest(reference)) << kernel_target();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

TEST(ContactPulse, AContactPulseLeavesEachModeAsLoudAsItsSpectrumSays) {
  constexpr double kTau = 0.0015;
  for (const double f : {50.0, 200.0, 300.0, 700.0, 1200.0, 2500.0, 4000.0}) {
    double loud[2];
    for (const bool exact : {false, true}) {
      Player player;
      set(player.mixer, &MixerSettings::exact_contacts, exact);
      player.install(0, map_of(single_mode_bank(f, 0.01)));
      player.push(strike_at(0, 0, {0, 0, 1}, kTau));
      player.render(4800);
      loud[exact] = largest(player.left_from(200));
    }
    EXPECT_NEAR(loud[1], loud[0], 0.01 * ringdown::test::kLoudness * 2 * std::numbers::pi * f) << f << " Hz";
  }
}

TEST(ContactPulse, AContactPulseSoundsTheSameInAnyBlocksAndBesideAnything) {
  const Map map = map_of(random_bank(3, 200, 30));
  Samples reference;
  for (const std::size_t block : {256u, 1u, 100u, 1024u}) {
    Player player;
    set(player.mixer, &MixerSettings::exact_contacts, true);
    player.install(0, map);
    player.push(strike_at(10, 0, {1, 0, 0}, 0.004));
    player.push(strike_at(77, 0, {0, 1, 0}));
    player.push(strike_at(90, 0, {0, 0, 1}, 0.002, {-1, 0, 0}));
    player.push(gain_at(100, 0, 0.3, 0.01));
    player.push(pan_at(2000, 0, 0.5));
    player.push(strike_at(2100, 0, {1, 0, 0}, 0.001));
    player.render(6000, block);
    if (reference.empty()) reference = player.left;
    EXPECT_LE(largest_difference(player.left, reference), 3e-6 * largest(reference)) << "blocks of " << block;
    EXPECT_EQ(player.mixer.counters().strikes, 4u);
  }
}

TEST(ContactPulse, AContactPulseEndsWhenItsObjectIsClearedOrRemoved) {
  for (const bool clear : {true, false}) {
    Player player;
    set(player.mixer, &MixerSettings::exact_contacts, true);
    player.install(0, map_of(single_mode_bank(300, 1)));
    player.push(strike_at(0, 0, {0, 0, 1}, 0.1));
    player.render(1024);
    EXPECT_GT(largest(player.left), 0);
    if (clear) {
      player.push(clear_at(1024, 0));
    } else {
      ASSERT_TRUE(player.mixer.remove(0));
    }
    player.render(1024 + FadeOut::kMinFrames);
    EXPECT_EQ(largest(player.left_from(1024 + FadeOut::kMinFrames + 256)), 0) << (clear ? "clear" : "remove");
  }
}

TEST(ContactPulse, AContactPulseGoesOnWhenTheMaterialChanges) {
  Player player;
  set(player.mixer, &MixerSettings::exact_contacts, true);
  const Map map = map_of(single_mode_bank(300, 1));
  player.install(0, map);
  player.push(strike_at(0, 0, {0, 0, 1}, 0.02));
  player.render(512);
  player.install(0, map, Mixer::Install::retune, {.stiffness = 1 + 1e-9});
  player.render(4096);
  Player steady;
  set(steady.mixer, &MixerSettings::exact_contacts, true);
  steady.install(0, map);
  steady.push(strike_at(0, 0, {0, 0, 1}, 0.02));
  steady.render(512 + 4096);
  EXPECT_LE(largest_difference(player.left, steady.left), 1e-6 * largest(steady.left));
}

TEST(ContactPulse, AContactPulseBeyondTheLimitIsShapedByItsSpectrum) {
  constexpr ObjectNumber kObjects = 2 * kMaxDrives;
  Player player;
  set(player.mixer, &MixerSettings::exact_contacts, true);
  const Map map = map_of(single_mode_bank(200, 1));  // a whole period in half a pulse: in phase either way
  for (ObjectNumber object = 0; object < kObjects; ++object) {
    player.install(object, map);
    player.push(strike_at(0, object, {0, 0, 1}, 0.01));
  }
  for (std::size_t i = 0; i < 2 * kMaxForces; ++i) player.push(strike_at(1, 0, {0, 0, 1}, 0.01));
  player.render(4096);
  EXPECT_EQ(player.mixer.counters().strikes, kObjects + 2 * kMaxForces);
  Player one;
  one.install(0, map);
  one.push(strike_at(0, 0, {0, 0, 1}, 0.01));
  one.render(4096);
  const double sum = static_cast<double>(kObjects + 2 * kMaxForces);
  EXPECT_NEAR(largest(player.left_from(1000)), sum * largest(std::span(one.left).subspan(1000)),
              0.03 * sum * largest(one.left));
}

TEST(ContactPulse, AContactPulseOnObjectsOfOneTableSoundsAsOnEachAlone) {
  const Map map = map_of(random_bank(4, 60, 30));
  const auto table = std::make_shared<ModeTable>(map, modal::MaterialScale{}, kRate);
  Player shared, alone;
  for (Player* player : {&shared, &alone}) set(player->mixer, &MixerSettings::exact_contacts, true);
  for (ObjectNumber object = 0; object < 4; ++object) {
    ASSERT_TRUE(shared.mixer.install(object, std::make_unique<Voice>(table), Mixer::Install::replace));
    alone.install(object, map);
    for (Player* player : {&shared, &alone}) {
      player->push(strike_at(20, object, {1, 0, 0}));
      player->push(strike_at(30 + 40 * object, object, {0, 0, 1}, 0.003));
      player->push(strike_at(3000, object, {0, 1, 0}));
    }
  }
  shared.render(6000), alone.render(6000);
  EXPECT_LE(largest_difference(shared.left, alone.left), 3e-6 * largest(alone.left));
  EXPECT_LE(shared.mixer.counters().ringing_modes, 2 * 60u);
}

class Input : public testing::Test {
 protected:
  void SetUp() override {
    player.install(0, map_of(single_mode_bank(440, 5)));
    ASSERT_TRUE(player.mixer.connect_input(1, 0, {1, 1, 1}, {0, 0, 1}));
  }
  void render(std::span<const float> signal, std::size_t block) {
    std::vector<float> left(block), right(block);
    for (std::size_t at = 0; at + block <= signal.size(); at += block) {
      player.mixer.render(Outputs(left.data(), right.data()), Inputs{nullptr, signal.data() + at}, block);
      out.insert(out.end(), left.begin(), left.end());
    }
  }
  Player player;
  Samples out;
};

TEST_F(Input, AnImpulseInAnInputIsAStrike) {
  std::vector<float> signal(8192, 0.0f);
  signal[1500] = 1;
  render(signal, 1024);
  Player struck;
  struck.install(0, map_of(single_mode_bank(440, 5)));
  struck.push(strike_at(1500, 0, {0, 0, 1}));
  struck.render(8192);
  EXPECT_GT(largest(out), 0);
  EXPECT_LE(largest_difference(out, struck.left), 1e-6 * largest(out));
}

TEST_F(Input, NoiseRingsTheModeAsARecurrenceInLongDoubleDoes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> sample(-1, 1);
  std::vector<float> signal(6000);
  for (float& s : signal) s = sample(random);
  render(signal, 100);
  const long double omega = 2 * std::numbers::pi_v<long double> * 440;
  const Exact pole = std::exp(Exact(-5, omega) / Exact(kRate));
  Exact state = 0;
  Samples expected;
  for (const float s : signal) {
    expected.push_back(
        static_cast<double>(std::numbers::sqrt2_v<long double> / 2 * ringdown::test::kLoudness * omega * state.imag()));
    state = (state + static_cast<long double>(s)) * pole;
  }
  EXPECT_LE(largest_difference(out, expected), 1e-6 * largest(expected));
}

TEST_F(Input, ASilentInputCostsNothingAndADisconnectedOneIsNotHeard) {
  std::vector<float> signal(4096, 0.0f);
  render(signal, 512);
  EXPECT_EQ(player.mixer.counters().ringing_voices, 0u);
  ASSERT_TRUE(player.mixer.disconnect_input(1));
  signal.assign(4096, 1.0f);
  render(signal, 512);
  EXPECT_EQ(largest(out), 0);
}

TEST_F(Input, AnInputIsConnectedWhileFourPulsesAct) {
  ASSERT_TRUE(player.mixer.disconnect_input(1));
  set(player.mixer, &MixerSettings::exact_contacts, true);
  for (int i = 0; i < 4; ++i) player.push(strike_at(i, 0, {0, 0, 1e-9}, 0.1));
  std::vector<float> signal(512, 0.0f);
  render(signal, 512);
  ASSERT_TRUE(player.mixer.connect_input(1, 0, {1, 1, 1}, {0, 0, 1}));
  signal.assign(4096, 1.0f);
  const std::size_t before = out.size();
  render(signal, 512);
  EXPECT_GT(largest(std::span(out).subspan(before)), 1e-3);
}

TEST_F(Input, ASampleThatIsNotANumberSilencesItsObjectOnly) {
  player.install(7, map_of(single_mode_bank(1000, 5)));
  player.push(strike_at(0, 7, {0, 0, 1}));
  std::vector<float> signal(4096, 0.0f);
  signal[100] = std::numeric_limits<float>::quiet_NaN();
  render(signal, 256);
  EXPECT_EQ(player.mixer.counters().not_finite, 1u);
  EXPECT_GT(largest(std::span(out).subspan(2000)), 0);
  signal.assign(4096, 0.0f);
  signal[10] = 1;
  const double before = largest(std::span(out).subspan(3000));
  render(signal, 256);
  EXPECT_GT(largest(std::span(out).subspan(4096)), before) << "healed";
}

}  // namespace
}  // namespace ringdown::synth::test
