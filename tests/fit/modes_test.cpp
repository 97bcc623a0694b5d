// Modes found again in recordings whose modes are known.
#include "engine/fit/sinusoids.h"
#include "engine/fit/extent.h"
#include "engine/fit/modes.h"
#include "engine/modal/bank_file.h"
#include "tests/fit/recording.h"
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace ringdown::fit {
namespace {

using namespace ringdown::test;  // NOLINT: recordings
using test::kRate;

Fit fitted(const std::vector<double>& samples, const Options& options = {}, double rate = kRate) {
  const auto fit = fit_modes(samples, rate, options);
  if (!fit) {
    ADD_FAILURE() << fit.error().message;
    return {};
  }
  return *fit;
}

// The Cramer-Rao bound of frequency [Hz] and decay [1/s] of one damped sinusoid in white noise, by the Fisher
// information of its four numbers, summed sample by sample. Source: Yao & Pandit, IEEE Trans. Signal Process. 43(4),
// 1995.
struct Bound {
  double frequency_hz, decay_per_s;
};
Bound cramer_rao(const Tone& tone, double noise, double seconds) {
  // Complex amplitude and exponent turn real part and imaginary part of one 2 x 2 problem: with w = exp(-2 d t),
  // var(pole) = 2 noise^2 / A^2 * S0 / (S0 S2 - S1^2), Sk = sum t^k w.
  double s0 = 0, s1 = 0, s2 = 0;
  for (double t = 0; t < seconds; t += 1 / kRate) {
    const double w = std::exp(-2 * tone.decay_per_s * t);
    s0 += w, s1 += t * w, s2 += t * t * w;
  }
  const double deviation = std::sqrt(2 * noise * noise / (tone.amplitude * tone.amplitude) * s0 / (s0 * s2 - s1 * s1));
  return {deviation / (2 * std::numbers::pi), deviation};
}

TEST(FitModes, OneModeComesNearTheCramerRaoBound) {
  const Tone tone{1234.5, 4, 0.5, 0.7};
  const double noise = 0.01, seconds = 1.5;
  const Bound bound = cramer_rao(tone, noise, seconds);
  const auto clean = struck({tone}, seconds);
  double frequency = 0, decay = 0, claimed = 0;
  const int runs = 12;
  for (int run = 0; run < runs; ++run) {
    auto samples = clean;
    add_noise(samples, noise, 100 + run);
    const Fit fit = fitted(samples, {.low_hz = 1000, .high_hz = 1500});
    ASSERT_EQ(fit.modes.size(), 1u);
    frequency += std::pow(fit.modes[0].frequency_hz - tone.frequency_hz, 2) / runs;
    decay += std::pow(fit.modes[0].decay_per_s - tone.decay_per_s, 2) / runs;
    claimed += fit.modes[0].frequency_error_hz / runs;
    EXPECT_NEAR(fit.modes[0].amplitude, tone.amplitude, 0.01 * tone.amplitude);
    EXPECT_NEAR(fit.modes[0].phase_rad, tone.phase_rad, 0.03);
  }
  std::printf("frequency: %.2g Hz, bound %.2g, claimed %.2g; decay: %.2g 1/s, bound %.2g\n", std::sqrt(frequency),
              bound.frequency_hz, claimed, std::sqrt(decay), bound.decay_per_s);
  EXPECT_LT(std::sqrt(frequency), 2.5 * bound.frequency_hz);
  EXPECT_LT(std::sqrt(decay), 2.5 * bound.decay_per_s);
  EXPECT_GT(claimed, 0.7 * bound.frequency_hz) << "no estimate may claim to be better than the bound";
  EXPECT_LT(claimed, 2.5 * bound.frequency_hz);
}

TEST(FitModes, ABellsDoubletIsTwoModes) {
  const std::vector<Tone> tones = {{523.0, 1.2, 0.5, 0.3}, {523.5, 1.3, 0.4, -1}};
  auto samples = struck(tones, 2);
  add_noise(samples, 0.0005);
  const Fit fit = fitted(samples);
  ASSERT_EQ(fit.modes.size(), 2u);
  for (int m = 0; m < 2; ++m) {
    EXPECT_NEAR(fit.modes[m].frequency_hz, tones[m].frequency_hz, 0.01);
    EXPECT_NEAR(fit.modes[m].decay_per_s, tones[m].decay_per_s, 0.05);
    EXPECT_NEAR(fit.modes[m].amplitude, tones[m].amplitude, 0.02);
  }
}

TEST(FitModes, LongAndShortModesOfOnePitchAreToldApart) {
  const std::vector<Tone> tones = {{880, 1.5, 0.3, 0}, {905, 60, 1, 1}, {4000, 150, 0.7, 0}};
  auto samples = struck(tones, 3);
  add_noise(samples, 0.0003);
  const Fit fit = fitted(samples);
  ASSERT_EQ(fit.modes.size(), 3u);
  for (int m = 0; m < 3; ++m) {
    EXPECT_NEAR(fit.modes[m].frequency_hz / tones[m].frequency_hz, 1, 1e-3);
    EXPECT_NEAR(fit.modes[m].decay_per_s / tones[m].decay_per_s, 1, 0.02);
    EXPECT_NEAR(fit.modes[m].amplitude / tones[m].amplitude, 1, 0.02);
  }
}

TEST(FitModes, AFitOfABandKeepsItsModesAtTheirLevels) {
  const std::vector<Tone> tones = {{1060.578, 3.166, 0.5, 0.3}, {2892.765, 7.456, 0.05, 0.2}, {5586.302, 21, 0.1, 0}};
  const Fit fit = fitted(struck(tones, 2), {.low_hz = 500, .high_hz = 4000});
  for (const Tone& tone : {tones[0], tones[1]}) {
    const auto mode = std::ranges::min_element(
        fit.modes, {}, [&](const Mode& m) { return std::abs(m.frequency_hz - tone.frequency_hz); });
    ASSERT_NE(mode, fit.modes.end());
    EXPECT_NEAR(mode->frequency_hz, tone.frequency_hz, 1e-3);
    EXPECT_NEAR(mode->amplitude / tone.amplitude, 1, 0.02);
  }
  EXPECT_GT(fit.explained, 0.9);
}

// A preset's bank, struck in the real mixer at the sample point nearest to a place: its strongest modes there.
struct Rendered {
  std::vector<double> samples;
  std::vector<Tone> tones;  // by energy
};
Rendered render_preset(const std::string& name, const Vec3& place_m, std::size_t modes, double seconds) {
  auto bank = *modal::read_bank(RINGDOWN_SOURCE_DIR "/presets/banks/" + name + ".glb");
  const auto distance = [&](const modal::Vec3f& p) { return length(Vec3{p[0], p[1], p[2]} - place_m); };
  const auto point =
      static_cast<std::size_t>(std::ranges::min_element(bank.positions, {}, distance) - bank.positions.begin());
  const Vec3 impulse{0.3, 0.5, 0.8};
  bank.mass.reset();  // without the click, which is no mode
  bank.losses.clear();
  bank.radiation.emplace();
  std::vector<std::pair<double, std::size_t>> order;
  std::vector<Tone> tones(bank.mode_count());
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const auto& phi = bank.shape(m, point);
    const double answer = phi[0] * impulse.x + phi[1] * impulse.y + phi[2] * impulse.z;
    const double amplitude =
        ringdown::test::kLoudness / std::numbers::sqrt2 * 2 * std::numbers::pi * bank.frequency_hz[m] * answer;
    tones[m] = {bank.frequency_hz[m], bank.decay_per_s[m], amplitude};
    order.emplace_back(amplitude * amplitude / bank.decay_per_s[m], m);
  }
  std::ranges::sort(order, std::greater{});
  order.resize(modes);
  std::vector<Tone> kept;
  modal::Bank small = bank;
  small.frequency_hz.clear(), small.decay_per_s.clear(), small.frequency_error.clear(), small.shapes.clear();
  for (const auto& [energy, m] : order) {
    kept.push_back(tones[m]);
    small.frequency_hz.push_back(bank.frequency_hz[m]);
    small.decay_per_s.push_back(bank.decay_per_s[m]);
    small.radiation->maps.modes.push_back(ringdown::test::even_field(bank.frequency_hz[m]));
    for (std::size_t p = 0; p < bank.point_count(); ++p) small.shapes.push_back(bank.shape(m, p));
  }
  synth::test::Player player(kRate);
  player.install(0, synth::test::map_of(small));
  player.push(synth::test::vertex_strike_at(0, 0, static_cast<std::uint32_t>(point), impulse));
  player.render(static_cast<std::size_t>(seconds * kRate));
  return {player.left, kept};
}

// Tones so close that they do not beat once while they are heard: a round bell's pairs. They count as one.
std::vector<std::vector<Tone>> told_apart(std::vector<Tone> tones) {
  std::ranges::sort(tones, {}, &Tone::frequency_hz);
  std::vector<std::vector<Tone>> groups;
  for (const Tone& tone : tones) {
    const bool beats = groups.empty() || tone.frequency_hz - groups.back().back().frequency_hz > tone.decay_per_s / 20;
    if (beats) groups.emplace_back();
    groups.back().push_back(tone);
  }
  return groups;
}

// Within a fraction of the tone's resonance.
bool is_at(const Mode& mode, const Tone& tone) {
  return std::abs(mode.frequency_hz - tone.frequency_hz) < tone.decay_per_s / 4;
}

struct Score {
  std::size_t tones;                   // that can be told apart
  double found, cents = 0, decay = 0;  // share of them; median errors, the decay's relative
  std::size_t wrong;                   // modes where no tone is
};
Score score(const Fit& fit, const std::vector<Tone>& tones) {
  const auto groups = told_apart(tones);
  std::vector<double> off, slow;
  for (const auto& group : groups) {
    const auto nearest = std::ranges::min_element(
        fit.modes, {}, [&](const Mode& m) { return std::abs(m.frequency_hz - group[0].frequency_hz); });
    if (nearest == fit.modes.end() || !is_at(*nearest, group[0])) continue;
    off.push_back(std::abs(cents(nearest->frequency_hz / group[0].frequency_hz)));
    slow.push_back(std::abs(nearest->decay_per_s / group[0].decay_per_s - 1));
  }
  Score s{groups.size(), static_cast<double>(off.size()) / static_cast<double>(groups.size())};
  s.wrong = static_cast<std::size_t>(std::ranges::count_if(fit.modes, [&](const Mode& mode) {
    return std::ranges::none_of(tones, [&](const Tone& tone) { return is_at(mode, tone); });
  }));
  if (off.empty()) return s;
  std::ranges::sort(off), std::ranges::sort(slow);
  s.cents = off[off.size() / 2], s.decay = slow[slow.size() / 2];
  return s;
}

TEST(FitModes, FiftyModesOfABellAreFoundInNoise) {
  const struct {
    double snr_db, found, cents, decay;
    Vec3 place;
  } claims[] = {{60, 0.95, 0.02, 0.01, {-0.0857, 0.0038, 0.1425}},
                {40, 0.85, 0.1, 0.05, {0.1, 0.05, 0.1}},
                {20, 0.5, 0.5, 0.1, {0, -0.1, 0.09}}};
  std::size_t wrong = 0;
  for (const auto& claim : claims) {
    const Rendered bell = render_preset("bronze-bell", claim.place, 50, 2);
    auto samples = bell.samples;
    add_noise(samples, rms(bell.samples) * std::pow(10, -claim.snr_db / 20));
    const Fit fit = fitted(samples);
    const Score s = score(fit, bell.tones);
    std::printf("%2.0f dB: %3.0f %% of %zu found, %.4f cents, decay %.2f %%, %zu wrong, %.4f %% of the energy\n",
                claim.snr_db, 100 * s.found, s.tones, s.cents, 100 * s.decay, s.wrong, 100 * fit.explained);
    EXPECT_GE(s.found, claim.found);
    EXPECT_LE(s.cents, claim.cents);
    EXPECT_LE(s.decay, claim.decay);
    EXPECT_GT(fit.explained, 1 - 2 * std::pow(10, -claim.snr_db / 10) - 1e-3);
    wrong += s.wrong;
  }
  EXPECT_LE(wrong, std::size(claims)) << "one in fifty, on average";
}

TEST(FitModes, EveryModeOfAPlateIsFound) {
  const Rendered plate = render_preset("steel-plate", {0.0972, 0.09, 0.0015}, 120, 2);
  auto samples = plate.samples;
  add_noise(samples, 1e-3 * rms(plate.samples));
  const Score s = score(fitted(samples), plate.tones);
  std::printf("%3.0f %% of %zu found, %.4f cents, decay %.2f %%, %zu wrong\n", 100 * s.found, s.tones, s.cents,
              100 * s.decay, s.wrong);
  EXPECT_GE(s.found, 0.8);
  EXPECT_LE(s.cents, 0.1);
  EXPECT_LE(s.wrong, 5u);
}

TEST(FitModes, NoModeIsFoundInSilenceAndNoise) {
  EXPECT_TRUE(fitted(std::vector<double>(48000)).modes.empty());
  std::vector<double> noise(48000);
  add_noise(noise, 0.1);
  EXPECT_TRUE(fitted(noise).modes.empty());
  EXPECT_TRUE(fitted(noise, {.from_s = 0.1}).modes.empty());
}

TEST(FitModes, ASteadyToneIsNoMode) {
  auto samples = struck({{50, 0, 0.02}, {700, 6, 0.5}}, 2);
  add_noise(samples, 0.0005);
  const Fit fit = fitted(samples);
  ASSERT_EQ(fit.modes.size(), 1u);
  EXPECT_NEAR(fit.modes[0].frequency_hz, 700, 0.01);
}

TEST(FitModes, AnOffsetAndALateOnsetChangeNothing) {
  const std::vector<Tone> tones = {{440, 3, 0.3, 1.5}, {1870, 8, 0.4, 0.5}};
  auto samples = struck(tones, 2.5, 0.737);
  add_noise(samples, 0.0003);
  for (double& sample : samples) sample += 0.1;
  const Fit fit = fitted(samples);
  EXPECT_NEAR(fit.onset_s, 0.737, 0.0005);
  ASSERT_EQ(fit.modes.size(), 2u);
  for (int m = 0; m < 2; ++m) {
    EXPECT_NEAR(cents(fit.modes[m].frequency_hz / tones[m].frequency_hz), 0, 0.02);
    EXPECT_NEAR(fit.modes[m].decay_per_s, tones[m].decay_per_s, 0.03);
    EXPECT_NEAR(fit.modes[m].amplitude, tones[m].amplitude, 0.01);
  }
}

TEST(FitModes, AClippedBeginningIsLeftOutOfTheFit) {
  const std::vector<Tone> tones = {{600, 5, 0.9, 0.2}, {1500, 7, 0.8, 1}};
  auto samples = struck(tones, 2);
  for (double& sample : samples) sample = std::clamp(sample, -0.7, 0.7);
  add_noise(samples, 1e-5);
  for (double& sample : samples) sample = std::clamp(sample, -0.7, 0.7);
  const Fit fit = fitted(samples, {.low_hz = 200, .high_hz = 5000});
  EXPECT_GT(fit.clipped, 100u);
  EXPECT_GT(fit.start_s, fit.onset_s);
  ASSERT_EQ(fit.modes.size(), 2u);
  for (int m = 0; m < 2; ++m) {
    EXPECT_NEAR(cents(fit.modes[m].frequency_hz / tones[m].frequency_hz), 0, 0.02);
    EXPECT_NEAR(fit.modes[m].amplitude, tones[m].amplitude, 0.01 * tones[m].amplitude) << "as if it were not clipped";
  }
}

// Round peaks hold a few equal samples where the tone is low, or where the recording is quiet and rounded.
TEST(FitModes, ARoundPeakIsNotClipped) {
  for (const double frequency_hz : {30.0, 50.0, 110.0, 233.1}) {
    for (const double step : {0.0, 1 / 32768.0, 1 / 8388608.0}) {
      for (const double level : {0.9, 0.03, 3 * step}) {
        auto samples = struck({{frequency_hz, 2, level, 0.3}, {5 * frequency_hz, 6, 0.1 * level}}, 1, 0.05);
        for (double& sample : samples) sample = step > 0 ? step * std::round(sample / step) : sample;
        const auto extent = level > 0 ? find_extent(samples, kRate, {}) : std::nullopt;
        if (extent) {
          EXPECT_EQ(extent->clipped, 0U) << frequency_hz << " Hz, in steps of " << step << ", peak " << level;
        }
      }
    }
  }
}

TEST(FitModes, ALowToneThatIsCutOffIsClipped) {
  for (const double frequency_hz : {30.0, 110.0, 1000.0}) {
    for (const double step : {0.0, 1 / 32768.0}) {
      auto samples = struck({{frequency_hz, 2, 0.9, 0.3}}, 1, 0.05);
      for (double& sample : samples) sample = std::clamp(sample, -0.7, 0.7);
      for (double& sample : samples) sample = step > 0 ? step * std::round(sample / step) : sample;
      const auto extent = find_extent(samples, kRate, {});
      ASSERT_TRUE(extent);
      EXPECT_GT(extent->clipped, 50U) << frequency_hz << " Hz, in steps of " << step;
    }
  }
}

TEST(FitModes, TheFitEndsAtTheSecondBlow) {
  auto samples = struck({{440, 8, 0.5}}, 3);
  const auto again = struck({{440, 8, 0.5}}, 1.5);
  for (std::size_t n = 0; n < again.size(); ++n) samples[n + 72000] += again[n];
  add_noise(samples, 0.0003);
  const Fit fit = fitted(samples);
  EXPECT_NEAR(fit.end_s, 1.5, 0.01);
  ASSERT_EQ(fit.modes.size(), 1u);
  EXPECT_NEAR(fit.modes[0].decay_per_s, 8, 0.02);
}

TEST(FitModes, EverySampleRateGivesTheSameModes) {
  const std::vector<Tone> tones = {{333, 3, 0.3, 1}, {5000, 20, 0.4, 0.5}, {15000, 40, 0.3, 2}};
  for (const double rate : {44100.0, 48000.0, 96000.0}) {
    auto samples = struck(tones, 1, 0.1, rate);
    add_noise(samples, 0.0003);
    const Fit fit = fitted(samples, {}, rate);
    ASSERT_EQ(fit.modes.size(), 3u) << rate;
    for (int m = 0; m < 3; ++m) {
      EXPECT_NEAR(cents(fit.modes[m].frequency_hz / tones[m].frequency_hz), 0, 0.05);
      EXPECT_NEAR(fit.modes[m].decay_per_s / tones[m].decay_per_s, 1, 0.01);
    }
  }
}

TEST(FitModes, OptionsBoundWhatIsFound) {
  const std::vector<Tone> tones = {{300, 3, 0.3}, {900, 5, 0.2}, {2700, 8, 0.03}, {8100, 12, 0.003}};
  auto samples = struck(tones, 1.5);
  add_noise(samples, 1e-5);
  EXPECT_EQ(fitted(samples).modes.size(), 4u);
  EXPECT_EQ(fitted(samples, {.floor_db = 30}).modes.size(), 3u);
  EXPECT_EQ(fitted(samples, {.low_hz = 500, .high_hz = 3000}).modes.size(), 2u);
  const Fit two = fitted(samples, {.max_modes = 2});
  ASSERT_EQ(two.modes.size(), 2u);
  EXPECT_NEAR(two.modes[1].frequency_hz, 900, 0.01);
}

TEST(FitModes, TheFitRefusesWhatItCannotRead) {
  const std::vector<double> short_one(2000), long_one(48000);
  auto broken = long_one;
  broken[7] = NAN;
  EXPECT_FALSE(fit_modes(short_one, kRate));
  EXPECT_FALSE(fit_modes(broken, kRate));
  EXPECT_FALSE(fit_modes(long_one, 4000));
  EXPECT_FALSE(fit_modes(long_one, kRate, {.low_hz = 900, .high_hz = 800}));
  EXPECT_FALSE(fit_modes(long_one, kRate, {.floor_db = 0}));
  EXPECT_FALSE(fit_modes(long_one, kRate, {.max_modes = kMaxModes + 1}));
  EXPECT_TRUE(fit_modes(long_one, kRate, {.max_modes = kMaxModes}));
  EXPECT_FALSE(fit_modes(long_one, kRate, {.from_s = 0.99}));
}

}  // namespace
}  // namespace ringdown::fit
