// Pitches of the presets' banks against a list written by hand (preset_pitches.h), and of sounds whose pitch books
// give.
#include "engine/modal/bank_file.h"
#include "engine/modal/hearing/pitch.h"
#include "engine/modal/scaled_bank.h"
#include "tests/modal/preset_pitches.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace ringdown::modal {
namespace {

namespace fs = std::filesystem;
using ringdown::test::PresetPitch;

const fs::path kBanks = fs::path(RINGDOWN_SOURCE_DIR) / "presets/banks";

double cents(double a_hz, double b_hz) { return 1200 * std::log2(a_hz / b_hz); }

// "Fs3" in Hz, at A4 = 440 Hz.
double note_hz(const std::string& note) {
  const double semitone = static_cast<double>(std::string("C D EF G A B").find(note[0])) + (note[1] == 's' ? 1 : 0);
  return 440 * std::exp2((semitone - 9) / 12 + (note.back() - '4'));
}

// The list and the vibraphone's bars, which are called after their notes.
std::vector<std::pair<fs::path, std::vector<double>>> all_presets() {
  std::vector<std::pair<fs::path, std::vector<double>>> all;
  for (const PresetPitch& preset : ringdown::test::preset_pitches()) {
    all.emplace_back(kBanks / (std::string(preset.preset) + ".glb"), preset.hz);
  }
  for (const auto& bar : fs::directory_iterator(kBanks / "vibraphone")) {
    all.emplace_back(bar.path(), std::vector{note_hz(bar.path().stem().string())});
  }
  return all;
}

bool is_one_of(double hz, const std::vector<double>& wanted) {
  return std::ranges::any_of(wanted, [hz](double one) { return std::abs(cents(hz, one)) <= 50; });
}

TEST(PresetPitch, EveryPresetIsInTheList) {
  std::set<std::string> banks, listed;
  for (const auto& bank : fs::directory_iterator(kBanks)) {
    if (bank.path().extension() == ".glb") banks.insert(bank.path().stem().string());
  }
  for (const PresetPitch& preset : ringdown::test::preset_pitches()) listed.emplace(preset.preset);
  EXPECT_EQ(banks, listed);
}

TEST(PresetPitch, EstimatesFindNineOfTenAndNoneWhereThereIsNone) {
  // The presets for which the estimate and the list part ways: no pitch is found, or another one: the bell's hum
  // is louder than its strike note; the crotale's and the gong's main mode has rivals within an octave.
  const std::set<std::string> missed = {"bronze-bell", "crotale", "gong"};
  // Things that the list calls unpitched, and that have one mode far from others.
  const std::set<std::string> pitched = {"brick", "crash-cymbal", "dinner-plate", "fork", "knife"};
  std::size_t with_pitch = 0, found = 0;
  for (const auto& [path, wanted] : all_presets()) {
    const std::string name = path.stem().string();
    Bank bank = read_bank(path).value();
    bank.pitch_hz.reset();
    const Pitch pitch = pitch_of(bank);
    SCOPED_TRACE(name + ": " + describe(pitch));
    EXPECT_FALSE(pitch.stated);
    EXPECT_GT(pitch.tone_hz, 0);
    EXPECT_EQ(pitch.hz.has_value(), pitch.reason.empty());
    if (wanted.empty()) {
      EXPECT_EQ(pitch.hz.has_value(), pitched.contains(name));
      continue;
    }
    const bool is_found = pitch.hz && is_one_of(*pitch.hz, wanted);
    EXPECT_EQ(is_found, !missed.contains(name));
    ++with_pitch;
    found += is_found;
  }
  EXPECT_GE(10 * found, 9 * with_pitch) << found << " of " << with_pitch;
  RecordProperty("found", static_cast<int>(found));
}

TEST(PresetPitch, StatedPitchesAreThoseOfTheListAndOfTheirObjects) {
  std::size_t stated = 0;
  for (const auto& [path, wanted] : all_presets()) {
    const Bank bank = read_bank(path).value();
    if (!bank.pitch_hz) continue;
    ++stated;
    const Pitch pitch = pitch_of(bank);
    EXPECT_TRUE(pitch.stated) << path;
    EXPECT_TRUE(is_one_of(pitch.hz.value_or(1), wanted)) << path << ": " << *bank.pitch_hz;
  }
  EXPECT_EQ(stated, 37 + 9) << "the vibraphone's bars, the keys of four instruments, the fork, bells and the gong";
}

// A bank of partials that are all struck and radiate alike: level_db is that of an ideal blow, at first.
struct Sounding {
  double hz, level_db, t60_s;
};

Bank sound_of(const std::vector<Sounding>& partials) {
  Bank bank{.name = "sound", .positions = {{0, 0, 0}}};
  for (const auto& [hz, level_db, t60_s] : partials) {
    bank.frequency_hz.push_back(hz);
    bank.decay_per_s.push_back(std::log(1000) / t60_s);
    // A bank without surface or maps radiates in proportion to omega.
    bank.shapes.push_back({0, 0, static_cast<float>(std::pow(10, level_db / 20) / hz)});
  }
  return bank;
}

TEST(Pitch, OfOnePartialIsThatPartial) {
  for (const double hz : {55.0, 440.0, 3520.0}) {
    const Pitch pitch = pitch_of(sound_of({{hz, 0, 1}}));
    ASSERT_TRUE(pitch.hz) << pitch.reason;
    EXPECT_NEAR(cents(*pitch.hz, hz), 0, 0.01);
  }
}

TEST(Pitch, OfATunedBarIsItsLowestModeThoughTheTenfoldOneIsLouder) {
  const Pitch pitch = pitch_of(sound_of({{220, 0, 6}, {880, 15, 4}, {2200, 30, 1}, {1711, -5, 2}}));
  ASSERT_TRUE(pitch.hz) << pitch.reason;
  EXPECT_NEAR(cents(*pitch.hz, 220), 0, 1);
}

// A church bell's partials by its strike note, from hum to octave nominal [Fletcher & Rossing, The Physics of Musical
// Instruments, table 21.1]. A clapper drives the upper ones more than a mallet would.
TEST(Pitch, OfABellIsAnOctaveBelowItsNominal) {
  const double strike_hz = 587;
  std::vector<Sounding> bell;
  for (const double ratio : {0.5, 1.0, 1.183, 1.506, 2.0, 2.514, 2.662, 3.011, 4.166}) {
    const bool is_weak = ratio < 2 || (ratio > 2 && ratio < 3);
    bell.push_back({ratio * strike_hz, (is_weak ? -10 : 0) + 12 * std::log2(ratio), 10 / ratio});
  }
  const Pitch pitch = pitch_of(sound_of(bell));
  ASSERT_TRUE(pitch.hz) << pitch.reason;
  EXPECT_NEAR(cents(*pitch.hz, strike_hz), 0, 1);
  for (Sounding& partial : bell) partial.hz *= partial.hz == strike_hz ? 0.9 : 1;
  EXPECT_NEAR(cents(*pitch_of(sound_of(bell)).hz, strike_hz), 0, 1) << "wherever the prime is";
}

TEST(Pitch, ManyUnrelatedPartialsHaveNone) {
  std::vector<Sounding> plate;
  for (int i = 0; i < 40; ++i) plate.push_back({300 + 71.3 * i + 17 * std::sin(i * i), 0, 1});
  EXPECT_FALSE(pitch_of(sound_of(plate)).hz);
}

TEST(Pitch, AClickHasNone) {
  const Pitch pitch = pitch_of(sound_of({{1000, 0, 0.02}}));
  EXPECT_FALSE(pitch.hz);
  EXPECT_DOUBLE_EQ(pitch.tone_hz, 1000) << "what comes closest to one";
}

TEST(Pitch, NothingAudibleHasNone) {
  const Pitch pitch = pitch_of(sound_of({{30000, 0, 1}}));
  EXPECT_FALSE(pitch.hz);
  EXPECT_GT(pitch.tone_hz, 0);
}

TEST(Pitch, StatedPitchesGoWithSizeAndMaterialAsModesDo) {
  Bank bank = sound_of({{440, 0, 1}});
  bank.pitch_hz = 220;
  EXPECT_DOUBLE_EQ(*pitch_of(bank).hz, 220) << "stated: whatever the modes are";
  const Bank other = scaled(bank, {.density = 4, .stiffness = 9, .size = 3});
  EXPECT_NEAR(*other.pitch_hz, 220 * std::sqrt(9.0 / 4) / 3, 1e-9);
  EXPECT_NEAR(*other.pitch_hz / other.frequency_hz[0], 0.5, 1e-4) << "as the mode, but for its decay";
  EXPECT_FALSE(scaled(bank, {.size = 1000}).pitch_hz) << "below 1 Hz no pitch is stated";
}

}  // namespace
}  // namespace ringdown::modal
