// A bank's damping found again from a sound, and a recording's bank that sounds like it.
#include "engine/fit/comparison.h"
#include "engine/fit/recorded_bank.h"
#include "engine/modal/bank_file.h"
#include "tests/fit/recording.h"
#include "tests/synth/player.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

namespace ringdown::fit {
namespace {

using namespace ringdown::test;  // NOLINT: recordings
using test::kRate;

const double kLoudness = ringdown::test::kLoudness / std::numbers::sqrt2;

modal::Bank preset(const std::string& name) {
  return *modal::read_bank(RINGDOWN_SOURCE_DIR "/presets/banks/" + name + ".glb");
}

// A loss factor that is a straight line over the pitch, from one value at 1 kHz: its power of frequency.
struct Loss {
  double at_1_khz, power = 0;
  [[nodiscard]] double at(double frequency_hz) const { return at_1_khz * std::pow(frequency_hz / 1000, power); }
};

// Returns the losses of a mode to air, heat and supports.
double others(const modal::Bank& bank, std::size_t m) {
  return bank.losses[m].total_per_s() - bank.losses[m].material_per_s;
}

// What the bank would sound like with another loss factor and tuning, as its 40 first modes; decays and frequencies by
// the textbook's equations.
std::vector<double> other_loss(const modal::Bank& bank, const Loss& loss, double tuning_cents, double seconds) {
  std::vector<Tone> tones;
  for (std::size_t m = 0; m < std::min<std::size_t>(40, bank.mode_count()); ++m) {
    const double two_pi = 2 * std::numbers::pi, factor = std::exp2(tuning_cents / 1200);
    const double w = two_pi * bank.frequency_hz[m], d = bank.decay_per_s[m];
    const double w0 = std::sqrt(w * w + d * d) * factor, decay = 0.5 * w0 * loss.at(w0 / two_pi) + others(bank, m);
    const double amplitude = 0.02 * (1 + static_cast<double>(m % 5));
    tones.push_back({std::sqrt(w0 * w0 - decay * decay) / two_pi, decay, amplitude, 0.3 * static_cast<double>(m)});
  }
  auto samples = struck(tones, seconds, 0.05);
  add_noise(samples, 1e-3 * rms(samples));
  return samples;
}

// Modes at random pitches of three octaves: with n of them in 3600 cents and a tolerance of t, a heard mode has one
// within t by chance with probability 1 - exp(-2 t n / 3600); the search of the tuning finds somewhat more.
TEST(Chance, FewModesMatchByChanceInASparseBankAndMostInADenseOne) {
  std::mt19937 random(5);
  const auto pitches = [&random](std::size_t count) {
    std::vector<double> hz;
    for (std::size_t m = 0; m < count; ++m)
      hz.push_back(1000 * std::exp2(3.0 * static_cast<double>(random()) / 4294967296.0));
    std::ranges::sort(hz);
    return hz;
  };
  for (const std::size_t modes : {8, 60}) {
    modal::Bank bank;
    bank.frequency_hz = pitches(modes);
    bank.decay_per_s.assign(modes, 5);
    const std::array<NuBank, 3> banks{NuBank{0.1, &bank}, NuBank{0.2, &bank}, NuBank{0.3, &bank}};
    std::vector<Mode> heard;
    for (const double hz : pitches(10)) heard.push_back({.frequency_hz = hz, .decay_per_s = 5, .amplitude = 0.1});
    const Chance chance = chance_of(heard, NuCurves(banks), {.tolerance_cents = 15, .max_tuning_cents = 100}, 8);
    const double expected = 10 * (1 - std::exp(-2 * 15 * static_cast<double>(modes) / 3600));
    std::printf("%zu modes: %.1f of 10 by chance, %.1f without a search\n", modes, chance.matches, expected);
    EXPECT_GT(chance.matches, 0.9 * expected);
    EXPECT_LT(chance.matches, expected + 2.5);
    EXPECT_LE(chance.share, modes == 8 ? 0.0 : 0.7);
  }
}

TEST(Merge, TheSameModeOfTwoRecordingsIsOneAndAPairOfOneRecordingIsTwo) {
  const auto mode = [](double hz, double decay, double amplitude) {
    return Mode{.frequency_hz = hz, .decay_per_s = decay, .amplitude = amplitude, .decay_error_per_s = 0.01 * decay};
  };
  const std::vector<std::vector<Mode>> recordings = {{mode(1000.0, 4, 0.5), mode(1001.0, 4.2, 0.3)},
                                                     {mode(1000.1, 4.1, 0.1), mode(1000.9, 4.1, 0.4)},
                                                     {mode(1000.95, 4.1, 0.4)}};
  const std::vector<Mode> merged = merge(recordings);
  ASSERT_EQ(merged.size(), 2u);
  EXPECT_NEAR(merged[0].frequency_hz, 1000.05, 0.02);
  EXPECT_NEAR(merged[1].frequency_hz, 1000.95, 0.02);
  EXPECT_EQ(merged[0].amplitude, 0.5);
}

TEST(Merge, WhatARoomAddsBesideAModeIsLeftOut) {
  const std::vector<std::vector<Mode>> recordings = {{{.frequency_hz = 1042.8, .decay_per_s = 20, .amplitude = 0.1},
                                                      {.frequency_hz = 1045.7, .decay_per_s = 4.6, .amplitude = 0.2},
                                                      {.frequency_hz = 1060, .decay_per_s = 5, .amplitude = 0.02},
                                                      {.frequency_hz = 1500, .decay_per_s = 20, .amplitude = 0.1}}};
  const std::vector<Mode> merged = merge(recordings);
  ASSERT_EQ(merged.size(), 3u) << "weak, but no shorter; or far away: modes of their own";
  EXPECT_EQ(merged[0].frequency_hz, 1045.7);
}

TEST(Calibrate, OneLossFactorOfADetunedRecordingIsFound) {
  const modal::Bank bank = preset("porcelain-bowl");
  const Loss loss{3.1e-3};
  const auto fit = fit_modes(other_loss(bank, loss, 10, 1.5), kRate);
  ASSERT_TRUE(fit);
  const auto found = calibrate(fit->modes, bank);
  ASSERT_TRUE(found) << found.error().message;
  for (const modal::LossFactor& point : found->loss_factors) EXPECT_NEAR(point.eta / loss.at_1_khz, 1, 0.04);
  EXPECT_NEAR(found->tuning_cents, 10, 0.1);
  EXPECT_GE(found->matches.size(), 20u) << "of 40 modes, most in pairs too close to tell apart";
  EXPECT_LT(found->spread, 0.05);
}

std::vector<Mode> modes_of(const modal::Bank& bank, const Loss& loss) {
  std::vector<Mode> modes;
  for (std::size_t m = 0; m < std::min<std::size_t>(30, bank.mode_count()); ++m) {
    const double f = bank.frequency_hz[m], decay = std::numbers::pi * f * loss.at(f) + others(bank, m);
    modes.push_back({.frequency_hz = f, .decay_per_s = decay, .amplitude = 1, .decay_error_per_s = 0.01 * decay});
  }
  return modes;
}

TEST(Calibrate, ALossFactorThatChangesWithFrequencyGetsMoreThanOneFigure) {
  const modal::Bank bank = preset("steel-plate");
  for (const double power : {0.5, -0.7}) {
    const Loss loss{2e-3, power};
    const auto found = calibrate(modes_of(bank, loss), bank);
    ASSERT_TRUE(found);
    EXPECT_GE(found->loss_factors.size(), 2u);
    ASSERT_EQ(found->loss_factors.size(), found->loss_errors.size());
    for (std::size_t k = 0; k < found->loss_factors.size(); ++k) {
      const auto& [frequency_hz, eta] = found->loss_factors[k];
      EXPECT_NEAR(eta / loss.at(frequency_hz), 1, 0.05) << frequency_hz;
      EXPECT_GT(found->loss_errors[k], 0);
      EXPECT_LT(found->loss_errors[k], 0.2);
    }
  }
}

// Modes up to 5 cents off, as a coarse mesh leaves them: the median of these offs moves with the modes that count.
TEST(Calibrate, TheTuningDoesNotDependOnWhereItsSearchBegins) {
  const modal::Bank bank = preset("steel-plate");
  std::vector<Mode> modes = modes_of(bank, {2e-3});
  std::mt19937 random(2);
  for (Mode& mode : modes)
    mode.frequency_hz *= std::exp2((1 + 10 * static_cast<double>(random()) / 4294967296.0) / 1200);
  const auto first = calibrate(modes, bank, {.max_tuning_cents = 30});
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->tuning_cents, 6, 1.5);
  for (const double around_cents : {0.3, -0.7, 4.1}) {
    const auto found = calibrate(modes, bank, {.max_tuning_cents = 30, .around_cents = around_cents});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->tuning_cents, first->tuning_cents) << around_cents;
  }
}

TEST(Calibrate, CalibrationLeavesOutModesThatAreClamped) {
  const modal::Bank bank = preset("steel-plate");
  const Loss loss{1.5e-3};
  auto modes = modes_of(bank, loss);
  for (std::size_t m = 0; m < modes.size(); m += 5) modes[m].decay_per_s *= 4;
  const auto found = calibrate(modes, bank);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->loss_factors.size(), 1u);
  EXPECT_NEAR(found->loss_factors[0].eta / loss.at_1_khz, 1, 0.01);
  EXPECT_EQ(found->used(), found->matches.size() - modes.size() / 5);
}

// A recording in which everything rings longer than the air alone would let it: the material keeps a share.
TEST(Calibrate, AMaterialNeverGains) {
  const modal::Bank bank = preset("steel-plate");
  auto modes = modes_of(bank, {1e-4});
  for (Mode& mode : modes) mode.decay_per_s *= 0.1;
  const auto found = calibrate(modes, bank);
  ASSERT_TRUE(found);
  for (const modal::LossFactor& point : found->loss_factors) EXPECT_GT(point.eta, 0);
  for (const modal::ModeLoss& loss : with_losses(bank, *found).losses) EXPECT_GT(loss.material_per_s, 0);
}

TEST(Calibrate, CalibrationRefusesARecordingOfAnotherThing) {
  const modal::Bank bank = preset("wooden-bar");
  const std::vector<Mode> two = {{.frequency_hz = 5000, .decay_per_s = 3, .amplitude = 1},
                                 {.frequency_hz = 60, .decay_per_s = 3, .amplitude = 1}};
  const auto found = calibrate(two, bank);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("match"), std::string::npos);
  EXPECT_FALSE(calibrate({}, bank));
}

TEST(Calibrate, TheCalibratedBankKeepsItsUndampedModes) {
  const modal::Bank bank = preset("bronze-bell");
  const Calibration calibration{.loss_factors = {{500, 1e-3}, {5000, 2e-3}}};
  const modal::Bank damped = with_losses(bank, calibration);
  ASSERT_EQ(damped.mode_count(), bank.mode_count());
  EXPECT_EQ(damped.material->loss_factors.size(), 2u);
  EXPECT_EQ(damped.shapes, bank.shapes);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double w0 = 2 * std::numbers::pi * bank.frequency_hz[m], d0 = bank.decay_per_s[m];
    const double w1 = 2 * std::numbers::pi * damped.frequency_hz[m], d1 = damped.decay_per_s[m];
    EXPECT_NEAR((w1 * w1 + d1 * d1) / (w0 * w0 + d0 * d0), 1, 1e-12);
    const double f = std::sqrt(w0 * w0 + d0 * d0) / (2 * std::numbers::pi);
    const double eta = f < 500 ? 1e-3 : f > 5000 ? 2e-3 : 1e-3 * std::pow(2, std::log10(f / 500));
    EXPECT_NEAR(damped.losses[m].material_per_s / (std::numbers::pi * f * eta), 1, 1e-9);
    EXPECT_NEAR(d1, damped.losses[m].total_per_s(), 1e-9 * d1);
  }
}

// Written, read again, and struck in the real mixer.
TEST(ToBank, ARecordingsBankPlaysWithTheRecordedAmplitudes) {
  const std::vector<Tone> tones = {{440, 3, 0.3}, {1870, 8, 0.2, std::numbers::pi}, {7000, 30, 0.1}};
  std::vector<Mode> modes;
  for (const Tone& t : tones) {
    modes.push_back({.frequency_hz = t.frequency_hz,
                     .decay_per_s = t.decay_per_s,
                     .amplitude = t.amplitude,
                     .phase_rad = t.phase_rad});
  }
  const Vec3 impulse{0.1, -0.2, 0.05};
  for (const double contact_s : {0.0, 1e-4}) {
    const modal::Bank bank = to_bank(modes, {impulse, contact_s}, kLoudness, "three");
    const std::string path = testing::TempDir() + "ringdown_to_bank_test.glb";
    ASSERT_TRUE(modal::write_bank(bank, path));
    const auto read = modal::read_bank(path);
    ASSERT_TRUE(read) << read.error().message;
    synth::test::Player player(kRate);
    player.install(0, synth::test::map_of(*read));
    player.push(synth::test::strike_at(0, 0, impulse, contact_s));
    player.render(48000);
    EXPECT_LT(relative_error_db(player.left, struck(tones, 1)), -60) << contact_s;
  }
}

// One mode of amplitude A in a channel of the recording, which a blow of 0.5 N s made: a tenth of that blow peaks at a
// tenth, and a centred object sounds 3 dB louder than one channel.
TEST(ToBank, ARecordedBankStatesThePressureAtWhichABlowPeaks) {
  const std::vector<Mode> modes = {{.frequency_hz = 500, .decay_per_s = 1, .amplitude = 0.3}};
  const modal::Bank bank = to_bank(modes, {.impulse_ns = {0, 0, 0.5}}, kLoudness, "cup");
  EXPECT_NEAR(bank.provenance.peak_pa, 0.1 * 0.3 * std::sqrt(2) * modal::kFullScale_pa, 0.001);
}

}  // namespace
}  // namespace ringdown::fit
