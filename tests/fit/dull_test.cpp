// Blows that are dull: modes that die within some milliseconds, and the noise of the contact.
#include "engine/fit/band_powers.h"
#include "engine/fit/burst.h"
#include "engine/fit/pursuit.h"
#include "engine/fit/settle.h"
#include "tests/fit/recording.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ringdown::fit {
namespace {

using namespace ringdown::test;  // NOLINT: recordings
using test::kRate;

constexpr std::size_t kOnset = 9600;

double t60_decay(double seconds) { return 3 * std::log(10.0) / seconds; }

// White noise that begins at the onset and decays.
std::vector<double> decaying_noise(double level, double t60_s, double seconds, std::uint32_t seed) {
  std::vector<double> samples(static_cast<std::size_t>(seconds * kRate));
  add_noise(samples, level, seed);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    samples[n] *= n < kOnset ? 0 : std::exp(-t60_decay(t60_s) * static_cast<double>(n - kOnset) / kRate);
  }
  return samples;
}

double distance(const std::vector<double>& recorded, const std::vector<double>& model) {
  return distance_db(band_powers(recorded, kRate, kOnset), band_powers(model, kRate, kOnset),
                     band_noise(recorded, kRate, kOnset));
}

TEST(BandPowers, ASineHasItsMeanSquareInItsBand) {
  const auto samples = struck({{1000, 0, 0.5}}, 0.5);
  const BandPowers powers = band_powers(samples, kRate, 0);
  const auto band = static_cast<std::size_t>(std::ranges::find_if(powers.centre_hz, [](double f) { return f > 999; }) -
                                             powers.centre_hz.begin());
  EXPECT_NEAR(powers.power(band, 20), 0.125, 0.004);
  EXPECT_EQ(powers.bands(), 24u);
  EXPECT_EQ(powers.cells, 50u);
}

TEST(Distance, TheLevelDoesNotCountAndTheSpectrumDoes) {
  auto recorded = struck({{500, 8, 0.3}, {4000, 8, 0.3}}, 1, 0.2);
  add_noise(recorded, 1e-5);
  auto twice = recorded;
  for (double& sample : twice) sample *= 2;
  EXPECT_LT(distance(recorded, recorded), 1.5) << "the noise is added to a model that has it already";
  EXPECT_NEAR(distance(recorded, twice), distance(recorded, recorded), 0.6);
  const double tilted = distance(recorded, struck({{500, 8, 0.3}, {4000, 8, 0.03}}, 1, 0.2));
  EXPECT_GT(tilted, 7) << "half of the cells are 20 dB off, the level between them aligned";
  EXPECT_LT(tilted, 12);
}

TEST(Distance, EveryCellAboveTheNoiseCountsAndNoOther) {
  // One band, ten cells of noise 1, then cells of a sound: two that stand out alone and one that does not.
  const std::vector<double> noise = {1};
  BandPowers recorded{.centre_hz = {1000}, .cells = 6, .values = {1, 8, 1, 3.9, 1, 8}};
  const BandPowers silent{.centre_hz = {1000}, .cells = 6, .values = std::vector<double>(6, 0)};
  EXPECT_EQ(heard_cells(recorded, noise), (std::vector<bool>{false, true, false, false, false, true}));
  EXPECT_EQ(sure_cells(recorded, noise), std::vector<bool>(6, false)) << "no two together";
  EXPECT_NEAR(distance_db(recorded, silent, noise), 9.03, 0.01) << "the noise alone: no gain helps";
  BandPowers model = silent;
  for (const std::size_t c : {std::size_t{1}, std::size_t{5}}) model.values[c] = 7e3;
  EXPECT_NEAR(distance_db(recorded, model, noise), 0, 0.02) << "whatever its level is";
  EXPECT_NEAR(distance_as_played_db(recorded, model, noise, heard_cells(recorded, noise)), 29.4, 0.1);
  model.values[5] *= 4;
  EXPECT_NEAR(distance_db(recorded, model, noise), 3, 0.5) << "6 dB between two cells: 3 to either side";
}

TEST(Distance, TheGainIsTheOneThatBringsItNearest) {
  auto recorded = struck({{500, 8, 0.3}, {4000, 30, 0.1}}, 1, 0.2);
  add_noise(recorded, 1e-3);
  const auto model = struck({{500, 9, 0.2}, {4000, 25, 0.1}}, 1, 0.2);
  const BandPowers of_recorded = band_powers(recorded, kRate, kOnset), of_model = band_powers(model, kRate, kOnset);
  const std::vector<double> noise = band_noise(recorded, kRate, kOnset);
  const auto heard = heard_cells(of_recorded, noise);
  double nearest = INFINITY;
  for (double gain_db = -20; gain_db < 20; gain_db += 0.05) {
    BandPowers scaled = of_model;
    for (double& power : scaled.values) power *= std::pow(10, gain_db / 10);
    nearest = std::min(nearest, distance_as_played_db(of_recorded, scaled, noise, heard));
  }
  EXPECT_NEAR(distance_db(of_recorded, of_model, noise), nearest, 0.01);
}

TEST(Pursuit, ModesThatDieWithinFiveToTwentyMillisecondsAreFound) {
  const std::vector<Tone> tones = {
      {700, t60_decay(0.02), 0.5, 0.4}, {1900, t60_decay(0.01), 0.5, 1}, {5200, t60_decay(0.005), 0.4, 2}};
  auto samples = struck(tones, 0.5, 0.2);
  add_noise(samples, 1e-4);
  const auto fit = fit_modes(samples, kRate);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->explained, 0.98);
  for (const Tone& tone : tones) {
    const auto nearest = std::ranges::max_element(fit->modes, {}, [&](const Mode& m) {  // the loudest that is near
      return std::abs(cents(m.frequency_hz / tone.frequency_hz)) < 100 ? m.amplitude : 0;
    });
    EXPECT_NEAR(cents(nearest->frequency_hz / tone.frequency_hz), 0, 40) << tone.frequency_hz;
    EXPECT_NEAR(nearest->decay_per_s / tone.decay_per_s, 1, 0.25) << tone.frequency_hz;
  }
}

TEST(Burst, TheNoiseOfAContactIsKeptInAtMostFortyNumbers) {
  auto recorded = decaying_noise(0.2, 0.05, 0.8, 3);
  add_noise(recorded, 1e-4, 4);
  const Burst burst = fit_burst(recorded, kRate, kOnset, {});
  EXPECT_LE(burst.numbers(), kMaxBurstNumbers);
  const auto model = played_from(burst_modes(burst), kRate, kOnset, recorded.size());
  const double off = distance(recorded, model);
  const double other = distance(decaying_noise(0.2, 0.05, 0.8, 5), model);
  std::printf("%.2f dB from the noise it was fitted to, %.2f dB from another piece of it\n", off, other);
  EXPECT_LT(off, 4);
  EXPECT_LT(other, 5) << "a copy of the recording is no model";
  constexpr double kAbove_db = -1.3;  // the part of white noise that lies above the bands, from 17.8 kHz on
  EXPECT_NEAR(20 * std::log10(rms(model) / rms(recorded)), kAbove_db, 0.5) << "as loud as the recording";
}

TEST(Burst, TheSameBurstIsPlayedAlikeAndASilentOneNotAtAll) {
  auto recorded = decaying_noise(0.2, 0.02, 0.5, 6);
  const Burst burst = fit_burst(recorded, kRate, kOnset, {});
  const auto once = burst_modes(burst), again = burst_modes(burst);
  ASSERT_EQ(once.size(), again.size());
  ASSERT_FALSE(once.empty());
  for (std::size_t m = 0; m < once.size(); ++m) {
    EXPECT_EQ(once[m].frequency_hz, again[m].frequency_hz);
    EXPECT_EQ(once[m].amplitude, again[m].amplitude);
  }
  Burst silent = burst;
  std::ranges::fill(silent.level, 0.0);
  EXPECT_TRUE(burst_modes(silent).empty());
}

TEST(Burst, ACleanRingHasNone) {
  auto samples = struck({{440, 3, 0.3}, {1870, 8, 0.2}, {7000, 30, 0.1}}, 1.2, 0.2);
  add_noise(samples, 1e-4);
  const auto fit = fit_modes(samples, kRate);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->modes.size(), 3u);
  const auto onset = static_cast<std::size_t>(std::round(fit->onset_s * kRate));
  const auto played = settle(samples, kRate, onset, fit->modes);
  EXPECT_LT(burst_modes(fit_burst(samples, kRate, onset, played)).size(), 60u) << "but for bands below the lowest mode";
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_NEAR(played[m].amplitude / fit->modes[m].amplitude, 1, 0.05);
    EXPECT_NEAR(played[m].decay_per_s / fit->modes[m].decay_per_s, 1, 0.05);
  }
}

TEST(Settle, ModesThatCancelInTheRecordingAreAsLoudInTheBank) {
  // Two modes 6 Hz apart that begin against each other: in a bank, whose sines begin at 0, one of them would be turned.
  auto samples = struck({{1000, 15, 0.5, 0.2}, {1006, 18, 0.48, 0.2 + 3.1}}, 0.8, 0.2);
  add_noise(samples, 1e-4);
  const std::vector<Mode> modes = {{.frequency_hz = 1000, .decay_per_s = 15, .amplitude = 0.5, .phase_rad = 1.5},
                                   {.frequency_hz = 1006, .decay_per_s = 18, .amplitude = 0.48, .phase_rad = 1.4}};
  const auto before = played_from(as_played(modes), kRate, kOnset, samples.size());
  const auto after = played_from(settle(samples, kRate, kOnset, modes), kRate, kOnset, samples.size());
  std::printf("%.2f dB before, %.2f dB after\n", distance(samples, before), distance(samples, after));
  EXPECT_LT(distance(samples, after), 0.7 * distance(samples, before));
}

}  // namespace
}  // namespace ringdown::fit
