// Samples for samplers: what the SFZ file promises, measured in the sound files, and read as a sampler reads it.
#include "server/session/sample_set.h"

#include "engine/modal/bank_file.h"
#include "tests/support/signal.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sndfile.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

namespace ringdown::session {
namespace {

using test::Samples;

// Regions with what they inherit, as the SFZ format has it: a header <group> begins anew, and opcodes are name=value.
struct Region : std::map<std::string, std::string> {
  [[nodiscard]] int number(const std::string& opcode) const { return std::stoi(at(opcode)); }
};

std::vector<Region> regions_of(const std::filesystem::path& sfz) {
  std::ifstream file(sfz);
  std::vector<Region> regions;
  Region global, group;
  Region* current = &global;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("//")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word == "<control>" || word == "<global>") {
        current = &global;
      } else if (word == "<group>") {
        group = global;
        current = &group;
      } else if (word == "<region>") {
        regions.push_back(group);
        current = &regions.back();
      } else {
        const std::size_t equals = word.find('=');
        EXPECT_NE(equals, word.npos) << word;
        (*current)[word.substr(0, equals)] = word.substr(equals + 1);
      }
    }
  }
  return regions;
}

class SampleSetTest : public testing::Test {
 protected:
  SampleSetTest() {
    options_.bank = folder_ / "tone.glb";
    options_.folder = folder_ / "tone";
    options_.max_s = 1;
    EXPECT_TRUE(modal::write_bank(test::single_mode_bank(kPitch_hz, 6), options_.bank));
  }

  SampleSet made() {
    auto set = write_sample_set(options_, [](double) { return true; });
    EXPECT_TRUE(set) << (set ? "" : set.error().message);
    return set.value_or(SampleSet{});
  }

  [[nodiscard]] Samples samples_of(const Region& region) const {
    const auto path = options_.folder / region.at("default_path") / region.at("sample");
    SF_INFO info{};
    SNDFILE* const file = sf_open(path.c_str(), SFM_READ, &info);
    EXPECT_NE(file, nullptr) << path;
    if (!file) return {};
    EXPECT_EQ(info.channels, 1);
    Samples samples(static_cast<std::size_t>(info.frames));
    EXPECT_EQ(sf_readf_double(file, samples.data(), info.frames), info.frames);
    sf_close(file);
    return samples;
  }

  static constexpr double kPitch_hz = 500;
  test::TemporaryFolder folder_;
  SampleSetOptions options_;
};

// The bar's mode at ten times the pitch is its loudest one at first.
TEST_F(SampleSetTest, ABarLiesOnTheKeyThatItIsTunedTo) {
  options_.bank = RINGDOWN_SOURCE_DIR "/presets/banks/vibraphone-key.glb";
  options_.max_s = 0.1;
  options_.velocities = options_.strikes = 1;
  const SampleSet set = made();
  EXPECT_NEAR(set.pitch_hz, 220, 0.1);
  EXPECT_EQ(set.key, 57);
  EXPECT_EQ(set.no_pitch, "");
  EXPECT_EQ(regions_of(set.sfz).at(0).number("pitch_keycenter"), 57);
}

TEST_F(SampleSetTest, WhatHasNoPitchSaysSoAndTheKeyThatIsAskedForCounts) {
  options_.bank = RINGDOWN_SOURCE_DIR "/presets/banks/ceramic-tile.glb";
  options_.max_s = 0.1;
  options_.velocities = options_.strikes = 1;
  EXPECT_NE(made().no_pitch, "");
  options_.folder = folder_ / "again";
  options_.pitch = 60;
  const SampleSet set = made();
  EXPECT_EQ(set.no_pitch, "");
  EXPECT_EQ(set.key, 60);
}

TEST_F(SampleSetTest, EveryKeyAndVelocityPlaysOneSampleInTurnAtItsPitch) {
  options_.keys = {60, 70};
  options_.velocities = 3;
  options_.strikes = 2;
  const SampleSet set = made();
  EXPECT_NEAR(set.pitch_hz, kPitch_hz, 1e-6 * kPitch_hz);
  EXPECT_EQ(set.key, 71);  // 493.9 Hz
  const auto regions = regions_of(set.sfz);
  EXPECT_EQ(regions.size(), set.samples);
  for (int key = 0; key < kKeys; ++key) {
    for (int velocity = 1; velocity < 128; ++velocity) {
      for (int turn = 1; turn <= 2; ++turn) {
        const auto plays = std::ranges::count_if(regions, [&](const Region& region) {
          return region.number("lokey") <= key && key <= region.number("hikey") && region.number("lovel") <= velocity &&
                 velocity <= region.number("hivel") && region.number("seq_position") == turn &&
                 region.number("seq_length") == 2;
        });
        ASSERT_EQ(plays, key >= 60 && key <= 70) << "key " << key << ", velocity " << velocity;
      }
    }
  }
  double loudest = 0;
  for (const Region& region : regions) {
    const Samples samples = samples_of(region);
    const auto tone = test::fit_damped_sinusoid(std::span(samples).subspan(4800, 9600), options_.sample_rate_hz);
    const double wanted_hz = 440 * std::exp2((region.number("pitch_keycenter") - 69) / 12.0);
    EXPECT_NEAR(1200 * std::log2(tone.frequency_hz / wanted_hz), 0, 0.1) << region.at("sample");
    for (const double sample : samples) loudest = std::max(loudest, std::abs(sample));
    EXPECT_EQ(samples.back(), 0);
    EXPECT_EQ(region.at("loop_mode"), "one_shot");
  }
  EXPECT_NEAR(loudest, 0.7, 1e-3);
}

// All layers hold one impulse, because SFZ scales them by (velocity / 127)^2; what differs is the contact.
TEST_F(SampleSetTest, SofterLayersAreDullerAndRepetitionsAreStrikesOfTheirOwn) {
  EXPECT_TRUE(modal::write_bank(test::random_bank(5, 60, 200), options_.bank));
  options_.velocities = 4;
  options_.strikes = 3;
  options_.contact_time_s = 0.0003;
  const auto regions = regions_of(made().sfz);
  ASSERT_EQ(regions.size(), 12u);
  const auto brightness = [&](const Region& region) {  // of the difference over the signal: grows with frequency
    const Samples samples = samples_of(region);
    double steps = 0, power = 0;
    for (std::size_t i = 1; i < samples.size(); ++i) {
      steps += std::pow(samples[i] - samples[i - 1], 2);
      power += std::pow(samples[i], 2);
    }
    return steps / power;
  };
  for (std::size_t layer = 1; layer < 4; ++layer) {
    EXPECT_GT(brightness(regions[3 * layer]), brightness(regions[3 * (layer - 1)]));
  }
  for (std::size_t turn = 1; turn < 3; ++turn) {
    const Samples first = samples_of(regions[9]), other = samples_of(regions[9 + turn]);
    double difference = 0, power = 0;
    for (std::size_t i = 0; i < std::min(first.size(), other.size()); ++i) {
      difference += std::pow(first[i] - other[i], 2);
      power += std::pow(first[i], 2);
    }
    EXPECT_GT(difference, 0.01 * power) << "turn " << turn;
    EXPECT_LT(difference, 10 * power) << "turn " << turn;
  }
}

TEST_F(SampleSetTest, PlacesAreChosenByKeySwitchesAndKeysMayBeReleased) {
  EXPECT_TRUE(modal::write_bank(test::random_bank(5, 60, 200), options_.bank));
  options_.places_m = {{0.1, 0, 0}, {0, 0.1, 0}};
  options_.release_s = 0.2;
  options_.velocities = options_.strikes = 1;
  options_.flac = true;
  const auto regions = regions_of(made().sfz);
  ASSERT_EQ(regions.size(), 2u);
  for (std::size_t place = 0; place < 2; ++place) {
    EXPECT_EQ(regions[place].at("sw_last"), std::to_string(place));
    EXPECT_EQ(regions[place].at("sw_hikey"), "1");
    EXPECT_EQ(regions[place].at("ampeg_release"), "0.2");
    EXPECT_EQ(regions[place].count("seq_length"), 0u);
    EXPECT_TRUE(regions[place].at("sample").ends_with(".flac"));
  }
  EXPECT_NE(samples_of(regions[0]), samples_of(regions[1]));
}

TEST_F(SampleSetTest, NothingIsLeftWhenItIsCancelledOrRefused) {
  int calls = 0;
  const auto cancelled = write_sample_set(options_, [&calls](double) { return ++calls < 30; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().kind, ErrorKind::cancelled);
  options_.keys = {0, 127};  // from 60 times as large
  EXPECT_TRUE(write_sample_set(options_, [](double) { return false; }).error().kind == ErrorKind::cancelled);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.path())) ++files;
  EXPECT_EQ(files, 1u) << "the bank";
  std::filesystem::create_directory(options_.folder);
  const auto refused = write_sample_set(options_, [](double) { return true; });
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("exists already"), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace ringdown::session
