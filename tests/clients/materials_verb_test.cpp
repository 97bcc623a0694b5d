// `ringdown materials` and `ringdown scale` as their user meets them.
#include "engine/modal/bank_file.h"
#include "tests/integration/process.h"
#include "tests/integration/sound_file.h"
#include "tests/support/signal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>

namespace ringdown::test {
namespace {

namespace fs = std::filesystem;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

auto ringdown(std::vector<std::string> words) {
  words.insert(words.begin(), RINGDOWN_BIN_DIR "/ringdown");
  return run(words);
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Materials, EveryMaterialIsListedWithThePitchOfABar) {
  const auto ran = ringdown({"materials"});
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  for (const auto& file : fs::directory_iterator(kPresets / "materials")) {
    if (file.is_directory()) continue;  // read only where --materials names it
    EXPECT_TRUE(holds(ran.output, "\n" + file.path().stem().string() + " ")) << ran.output;
  }
  // By Euler and Bernoulli, steel: 22.37 / (2 pi 0.2^2) sqrt(210e9 0.008^2 / 12 / 7800) = 1067 Hz; shear takes some 0.6
  // %.
  EXPECT_TRUE(holds(ran.output, " 106")) << ran.output;
}

TEST(Materials, OneMaterialIsShownWithTheSourcesOfItsFigures) {
  const auto ran = ringdown({"materials", "bamboo"});
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_TRUE(holds(ran.output, "Amada & Lakes")) << ran.output;
  EXPECT_TRUE(holds(ran.output, "loss factor at")) << ran.output;
  EXPECT_TRUE(holds(ran.output, "T60 at 1 kHz")) << ran.output;
}

TEST(Materials, MaterialsAsMarkdownAreTheDocumentationsPage) {
  const auto ran = ringdown({"materials", "--markdown"});
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_TRUE(holds(text_of(fs::path(RINGDOWN_SOURCE_DIR) / "docs/use/materials.md"), ran.output)) << "run ./run docs";
}

TEST(Materials, ABarSoundsAtThePitchThatIsPrinted) {
  const TemporaryFolder folder;
  const fs::path wav = folder.path() / "bar.wav";
  const auto ran = ringdown({"materials", "glass", "--sound", wav.string()});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  const Samples sound = read_left(wav);
  ASSERT_EQ(sound.size(), 96000u);
  EXPECT_NEAR(peak(sound), 0.7079, 1e-3);
  double printed = 0;
  ASSERT_EQ(std::sscanf(ran.output.substr(ran.output.find("glass,") + 6).c_str(), "%lf Hz", &printed), 1) << ran.output;
  // What is left after a second is the lowest mode.
  const auto heard = fit_damped_sinusoid(std::span(sound).subspan(48000), 48000);
  EXPECT_NEAR(heard.frequency_hz, printed, 0.1);
}

TEST(Materials, AnUnknownMaterialIsRefused) {
  const std::pair<std::vector<std::string>, int> cases[] = {{{"materials", "kryptonite"}, 3},
                                                            {{"materials", "--materials", "/nowhere"}, 3},
                                                            {{"materials", "--sound", "x.wav"}, 2},
                                                            {{"materials", "steel", "--sound", "/nowhere/x.wav"}, 1},
                                                            {{"materials", "steel", "--markdown"}, 2}};
  for (const auto& [words, code] : cases) EXPECT_EQ(ringdown(words).exit_code, code) << words.back();
}

TEST(Scale, ScalingWritesTheBankOfAnotherSizeAndMaterial) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "large.glb";
  const auto ran = ringdown({"scale", (kPresets / "banks/bronze-bell.glb").string(), "--size", "2", "-m", "brass",
                             "--name", "big", "-o", out.string()});
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_TRUE(holds(ran.output, "Poisson's ratio stays")) << ran.output;
  const auto before = modal::read_bank(kPresets / "banks/bronze-bell.glb"), after = modal::read_bank(out);
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->name, "big");
  EXPECT_EQ(after->material->name, "brass");
  EXPECT_EQ(after->material->poisson_ratio, before->material->poisson_ratio);
  const double mass = 8 * after->material->density_kg_m3 / before->material->density_kg_m3;
  EXPECT_NEAR(after->mass->mass_kg / before->mass->mass_kg, mass, 1e-6 * mass);
  const auto speed = [](const modal::Bank& bank) {
    return std::sqrt(bank.material->youngs_modulus_pa / bank.material->density_kg_m3);
  };
  EXPECT_NEAR(std::ranges::min(after->frequency_hz) / std::ranges::min(before->frequency_hz),
              0.5 * speed(*after) / speed(*before), 1e-5);
}

TEST(Scale, ImpossibleScalingsAreRefused) {
  const TemporaryFolder folder;
  const std::string bell = (kPresets / "banks/bronze-bell.glb").string(), out = (folder.path() / "x.glb").string();
  const std::pair<std::vector<std::string>, int> cases[] = {{{"scale", bell}, 2},
                                                            {{"scale", "/nowhere.glb", "-o", out}, 3},
                                                            {{"scale", bell, "-o", out, "--size", "0"}, 2},
                                                            {{"scale", bell, "-o", out, "--size", "1001"}, 2},
                                                            {{"scale", bell, "-o", out, "-m", "kryptonite"}, 3},
                                                            {{"scale", bell, "-o", "/nowhere/x.glb"}, 1}};
  for (const auto& [words, code] : cases) EXPECT_EQ(ringdown(words).exit_code, code) << words.back();
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace ringdown::test
