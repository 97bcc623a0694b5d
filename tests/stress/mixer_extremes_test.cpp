// Coefficients, numbers and levels at every extreme.
#include "tests/stress/company.h"
#include "tests/stress/exact_voice.h"
#include "tests/stress/mixer_table.h"
#include "tests/synth/mode_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <random>
#include <utility>

namespace ringdown::synth::test {
namespace {

constexpr double kPanGain = std::numbers::sqrt2 / 2;
const double kT60Exponent = std::log(1000.0);

double decibels(double ratio) { return 20 * std::log10(std::max(ratio, 1e-20)); }

struct Extreme {
  double rate, frequency_hz, t60_s, gain;
  std::size_t block;
  bool moments;
};

// Error of one mode over its envelope at that time, worst over its first 20000 frames; as long as floats can hold the
// state.
double worst_error_db(const Extreme& extreme) {
  constexpr Frame kStrike = 2000;
  constexpr std::size_t kCount = 20000;
  Player player(extreme.rate);
  set(player.mixer, &MixerSettings::floor_db, kNever);
  const Map map = map_of(single_mode_bank(extreme.frequency_hz, kT60Exponent / extreme.t60_s));
  player.install(0, map);
  if (extreme.moments) keep_company(player.mixer);
  const Event strike = vertex_strike_at(kStrike, 0, 0, {0, 0, 1});
  player.push(gain_at(0, 0, extreme.gain));
  player.push(strike);
  player.render(kStrike + kCount, extreme.block);
  ExactVoice voice(map, extreme.rate);
  const double amplitude = voice.strike(strike);
  const Samples exact = voice.samples(kStrike, kCount);
  double worst = 0;
  for (std::size_t n = 0; n < kCount; ++n) {
    const double decay = kT60Exponent / extreme.t60_s / extreme.rate * static_cast<double>(n);
    const double envelope = kPanGain * extreme.gain * amplitude * std::exp(-decay);
    if (envelope < 1e-30 * extreme.gain) break;
    const double difference = player.left[kStrike + n] - kPanGain * extreme.gain * exact[n];
    worst = std::max(worst, std::abs(difference) / envelope);
  }
  return decibels(worst);
}

TEST(StressExtremes, EveryPitchDecayAndGainIsTheClosedForm) {
  double worst = -400;
  int modes = 0;
  for (const double rate : {44100.0, 48000.0, 192000.0}) {
    for (const double pitch : {1 / rate, 1.37 / rate, 20 / rate, 1000.3 / rate, 0.25, 0.49, 0.499999, 0.5 - 1e-9}) {
      for (const double t60_s : {1e-3, 5e-3, 0.1, 3600.0}) {
        for (const bool moments : {false, true}) {
          const std::size_t block = std::array{128, 8192, 77}[static_cast<std::size_t>(modes) % 3];
          const Extreme extreme{rate, pitch * rate, t60_s, modes / 2 % 2 == 0 ? 1e6 : 1, block, moments};
          const double error = worst_error_db(extreme);
          EXPECT_LT(error, -100) << extreme.frequency_hz << " Hz, T60 " << t60_s << " s at " << rate
                                 << " Hz in blocks of " << block << (moments ? ", moments" : "");
          worst = std::max(worst, error);
          ++modes;
        }
      }
    }
  }
  enter({"one mode",
         text("%d modes: 1 Hz to 1 / 10^9 below Nyquist, T60 1 ms to 1 h, gains 1 and 1e6, 44.1 to 192 kHz", modes),
         text("%.1f dB of its envelope, at any time", worst), "-100 dB"});
}

TEST(StressExtremes, AGainOfZeroIsSilence) {
  Player player;
  keep_company(player.mixer);
  player.render(20000);
  EXPECT_GT(player.mixer.counters().ringing_modes, 1900u);
  EXPECT_EQ(peak(player.left_from(2000)), 0);
  EXPECT_EQ(player.mixer.counters().peak, 0.0f);
}

TEST(StressExtremes, TwentyThousandModesAreTheClosedForm) {
  modal::Bank bank = random_bank(5, 20000, 12);
  std::mt19937 random(5);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    bank.frequency_hz[m] = 0.49999 * kRate * uniform();
    bank.decay_per_s[m] = kT60Exponent / (1e-3 * std::pow(3.6e6, uniform()));
  }
  const Map map = map_of(std::move(bank));
  const Event strike = vertex_strike_at(1000, 0, 0, {1, 1, 1});
  ExactVoice voice(map, kRate);
  voice.strike(strike);
  Player player;
  player.install(0, map);
  player.push(strike);
  player.render(11 * 48000, 128);
  double worst = -400;
  for (const std::size_t first : {std::size_t{1000}, std::size_t{49000}, std::size_t{481000}}) {
    Samples exact = voice.samples(static_cast<Frame>(first), 400);
    for (double& sample : exact) sample *= kPanGain;
    worst = std::max(worst, relative_error_db(player.left_from(first).first(400), exact));
  }
  EXPECT_LT(worst, -110);
  enter({"20,000 modes", "T60 1 ms to 1 h; at once, after 1 s and 10 s", text("%.1f dB of the sum", worst), "-110 dB"});
}

// Pitches and decays scaled across and beyond what can ring: what cannot is never computed.
TEST(StressExtremes, OverDampedModesAndThoseAboveNyquistAreNeverComputed) {
  const modal::Bank bank = random_bank(6, 500, 12);
  const Map map = map_of(bank);
  std::size_t left_out = 0, played = 0;
  for (double alpha = 1e-6; alpha < 1e10; alpha *= 10) {
    for (double stiffness = 1e-12; stiffness < 1e13; stiffness *= 100) {
      std::size_t rings = 0;
      for (std::size_t m = 0; m < bank.mode_count(); ++m) {
        const double omega = 2 * std::numbers::pi * bank.frequency_hz[m], decay = bank.decay_per_s[m];
        const double squared = stiffness * (omega * omega + decay * decay) - std::pow(alpha * decay, 2);
        rings += squared > 0 && squared < std::pow(std::numbers::pi * kRate, 2);
      }
      const modal::MaterialScale material{.alpha = alpha, .stiffness = stiffness};
      EXPECT_EQ(voice_of(map, kRate, material)->table().playable_modes(), rings);
      Player player;
      player.install(0, map, Mixer::Install::replace, material);
      player.push(vertex_strike_at(0, 0, 0, {1, 1, 1}));
      player.render(256);
      EXPECT_LE(player.mixer.counters().ringing_modes, rings);
      for (const double sample : player.left) ASSERT_TRUE(std::isfinite(sample));
      played += rings;
      left_out += bank.mode_count() - rings;
    }
  }
  // Within a billionth of critical damping, on either side.
  const double omega = 2 * std::numbers::pi * 1000, decay = 5, critical = std::hypot(omega, decay) / decay;
  const Map one = map_of(single_mode_bank(1000, decay));
  EXPECT_EQ(voice_of(one, kRate, {.alpha = critical * (1 - 1e-9)})->table().playable_modes(), 1u);
  EXPECT_EQ(voice_of(one, kRate, {.alpha = critical * (1 + 1e-9)})->table().playable_modes(), 0u);
  enter({"materials", "damping times 1e-6 to 1e9, stiffness times 1e-12 to 1e12",
         text("%zu modes played; %zu over-damped or above Nyquist, none of them computed", played, left_out),
         "those of the closed form, exactly"});
}

bool is_denormal(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);  // a comparison would be fooled by the guard
  return (bits << 1) != 0 && (bits >> 23 & 0xff) == 0;
}
bool is_denormal(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return (bits << 1) != 0 && (bits >> 52 & 0x7ff) == 0;
}

struct Denormals {
  std::size_t states = 0, moments = 0, mixed = 0;
  [[nodiscard]] std::size_t all() const { return states + moments + mixed; }
};

// Tails that begin all along what floats can say, and die until doubles cannot say them.
Denormals denormals_of_a_dying_tail(Kernel kernel) {
  std::vector<Mode> modes;
  for (int i = 0; i < 64; ++i) {
    modes.push_back({40.0 + 370 * i, 0.03 + 0.001 * (i % 7), {std::pow(10.0, -5 * i % 320), -1e-30}});
  }
  Bundle bundle(modes, kRate, kernel);
  Denormals seen;
  for (int chunk = 0; chunk < 6000; ++chunk) {
    if (kernel == Kernel::moments) {
      for (const float sum : bundle.gather(64).of) seen.moments += is_denormal(sum);
    }
    const std::vector<double> out = bundle.render(64, {64});
    for (const double sample : out) seen.mixed += is_denormal(sample) || is_denormal(static_cast<float>(sample));
    for (const double sample : bundle.last_other) seen.mixed += is_denormal(sample);
    for (std::size_t i = 0; i < modes.size(); ++i) {
      seen.states += is_denormal(bundle.state(i).real()) + is_denormal(bundle.state(i).imag());
    }
  }
  return seen;
}

TEST(StressDenormals, NoStateMomentOrMixIsEverDenormal) {
  std::size_t without = 0;
  for (const Kernel kernel : {Kernel::direct, Kernel::moments}) {
    const Denormals unguarded = denormals_of_a_dying_tail(kernel);
    EXPECT_GT(unguarded.states, 1000u) << "the tails do not reach denormals: the test shows nothing";
    EXPECT_TRUE(kernel == Kernel::direct || unguarded.moments > 1000);
    without += unguarded.all();
    const DenormalGuard guard;
    const Denormals seen = denormals_of_a_dying_tail(kernel);
    EXPECT_EQ(seen.states, 0u);
    EXPECT_EQ(seen.moments, 0u);
    EXPECT_EQ(seen.mixed, 0u);
  }
  enter({"denormals", "64 tails from 1 to 1e-320, either kernel, each state, moment and mixed sample",
         text("0 (without the guard: %zu)", without), "0"});
}

// Voices that never rest, from every level down to nothing, while they fade, and at gains that make floats denormal.
TEST(StressDenormals, NoDenormalReachesTheSoundCard) {
  std::size_t near = 0;
  for (const bool moments : {false, true}) {
    for (const double gain : {1e-38, 1e-30, 1.0, 1e6}) {
      Player player;
      set(player.mixer, &MixerSettings::floor_db, kNever);
      modal::Bank bank = random_bank(9, 30, 12);
      std::ranges::fill(bank.decay_per_s, 70);
      player.install(0, map_of(std::move(bank)));
      if (moments) keep_company(player.mixer);
      player.push(gain_at(0, 0, gain));
      player.push(vertex_strike_at(1000, 0, 0, {1, 1, 1}));
      player.push(clear_at(40000, 0));
      player.push(vertex_strike_at(41000, 0, 0, {1e-35, 0, 0}));
      player.render(120000);
      for (const double sample : player.left) {
        ASSERT_FALSE(is_denormal(static_cast<float>(sample)));
        near += sample != 0 && std::abs(sample) < 1e-36;
      }
    }
  }
  EXPECT_GT(near, 1000u) << "nothing came near: the test shows nothing";
}

// What is wrong with a strike, and what happens to its object in the same chunk.
enum class Then { nothing, clear, retune, replace, remove, kCount };

class PoisonedScene {
 public:
  PoisonedScene(std::uint32_t seed, bool moments) : moments_(moments) {
    bank_ = random_bank(seed, 40, 12);
    if (seed % 2 == 0) return;
    // All silent within the chunk: what was wrong has gone when it ends.
    for (std::size_t m = 0; m < 40; ++m) bank_.decay_per_s[m] = m % 2 == 0 ? 1e5 : 2e4;
  }

  // Plays with the poison and without; the difference is the sound of the strike that heals, and no more.
  void expect_contained(const Event& poison, Then then) {
    const Map map = map_of(bank_);
    Player poisoned, healthy;
    poisoned.install(kVictim, map);
    for (Player* player : {&poisoned, &healthy}) {
      for (ObjectNumber object = 0; object < 3; ++object) {
        player->install(object, map_of(random_bank(object, 60, 12)));
        player->push(vertex_strike_at(100 * object, object, 1, {0.01, 0.02, 0}));
      }
      if (moments_) keep_company(player->mixer);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Event& refused : {gain_at(1500, 0, nan), pan_at(1501, 1, nan), gain_at(1502, 2, 1e308)})
      poisoned.push(refused);
    poisoned.push(gain_at(1503, 2, 1, nan));
    render_both(poisoned, healthy, static_cast<std::size_t>(poison.frame) / kChunkFrames * kChunkFrames);
    poisoned.push(poison);
    if (then == Then::clear) poisoned.push(clear_at(poison.frame, kVictim));
    render_both(poisoned, healthy, kChunkFrames);
    if (then == Then::retune) poisoned.install(kVictim, map, Mixer::Install::retune, {.stiffness = 1.1});
    if (then == Then::replace) poisoned.install(kVictim, map);
    if (then == Then::remove) {
      ASSERT_TRUE(poisoned.mixer.remove(kVictim));
      poisoned.install(kVictim, map);
    }
    const Event heal = vertex_strike_at(6000, kVictim, 2, {0.01, 0, 0.01});
    poisoned.push(heal);
    render_both(poisoned, healthy, 6000);
    EXPECT_EQ(poisoned.mixer.counters().refused, 3u);
    EXPECT_GE(poisoned.mixer.counters().not_finite, 1u);
    ExactVoice voice(map, kRate,
                     then == Then::retune ? modal::MaterialScale{.stiffness = 1.1} : modal::MaterialScale{});
    voice.strike(heal);
    const Samples healed = voice.samples(heal.frame, poisoned.left.size() - 6000);
    double worst = 0;
    for (std::size_t n = 0; n < poisoned.left.size(); ++n) {
      const double wanted = n < 6000 ? 0 : kPanGain * healed[n - 6000];
      const double error = std::abs(poisoned.left[n] - healthy.left[n] - wanted);
      worst = error <= worst ? worst : error;  // a NaN stays
    }
    // Either mixer may take the moments, the other not: off by 1.1e-6 of each mode at most.
    EXPECT_LT(worst, 4e-6 * peak(healthy.left));
  }

  static constexpr ObjectNumber kVictim = 7;

 private:
  static void render_both(Player& a, Player& b, std::size_t frames) {
    a.render(frames, 128);
    b.render(frames, 128);
  }
  modal::Bank bank_;
  bool moments_;
};

TEST(StressPoison, PoisonIsContainedAndHealedByTheNextStrike) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  int cases = 0;
  for (const bool moments : {false, true}) {
    for (const double bad : {nan, inf, -inf, 1e308, -1e308, 1e150, 1e45, 1e38, 1e30, 1e20, 1e16}) {
      for (int then = 0; then < static_cast<int>(Then::kCount); ++then) {
        for (const Frame frame : {2048, 2077}) {
          SCOPED_TRACE(text("impulse %g at frame %d, then %d%s", bad, static_cast<int>(frame), then,
                            moments ? ", moments" : ""));
          PoisonedScene(static_cast<std::uint32_t>(++cases), moments)
              .expect_contained(vertex_strike_at(frame, PoisonedScene::kVictim, 3, {0, bad, 0}),
                                static_cast<Then>(then));
        }
      }
    }
    const Event contact = vertex_strike_at(2050, PoisonedScene::kVictim, 3, {0, 1, 0}, nan);
    PoisonedScene(static_cast<std::uint32_t>(++cases), moments).expect_contained(contact, Then::nothing);
  }
  enter({"poison",
         text("%d: NaN, infinity, 1e16 to 1e308 in strikes, alone and before a clear, retune, swap or removal; NaN in "
              "gains, pans, ramps",
              cases),
         "none heard elsewhere; its object silenced, and exact after its next strike", "4e-6 of the loudest sample"});
}

}  // namespace
}  // namespace ringdown::synth::test
