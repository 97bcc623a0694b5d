// What is remembered, the spectrum, and how finely a slow machine draws.
#include "clients/viewer/settings.h"

#include "clients/viewer/spectrum.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace ringdown::viewer {
namespace {

TEST(Settings, WrittenSettingsAreReadBack) {
  const test::TemporaryFolder folder;
  const auto file = folder / "new" / "viewer.toml";
  Settings settings;
  settings.daemon = "osc.udp://studio:7771";
  settings.dark = false;
  settings.scale = 1.75;
  settings.width = 1001;
  settings.side_share = 0.31;
  settings.impulse_ns = 0.125;
  settings.listen = false;
  settings.strength_by_time = false;
  ASSERT_TRUE(write_settings(settings, file));
  const auto read = read_settings(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->daemon, settings.daemon);
  EXPECT_EQ(read->dark, false);
  EXPECT_EQ(read->scale, 1.75);
  EXPECT_EQ(read->width, 1001u);
  EXPECT_NEAR(read->side_share, 0.31, 1e-6);
  EXPECT_EQ(read->impulse_ns, 0.125);
  EXPECT_FALSE(read->listen);
  EXPECT_FALSE(read->strength_by_time);
}

TEST(Settings, AMalformedDaemonAddressIsKeptAsTyped) {
  const test::TemporaryFolder folder;
  Settings settings;
  settings.daemon = R"(a"b\c)";
  ASSERT_TRUE(write_settings(settings, folder / "viewer.toml"));
  const auto read = read_settings(folder / "viewer.toml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->daemon, settings.daemon);
}

TEST(Settings, WithoutAFileSettingsAreTheDefaults) {
  const auto read = read_settings("/nonexistent/viewer.toml");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->dark);
}

TEST(Settings, AMalformedSettingsFileIsNamedWithItsLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "viewer.toml";
  std::ofstream(file) << "dark = true\nscale = 100\n";
  const auto read = read_settings(file);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().message.find(file.string() + ":2"), std::string::npos) << read.error().message;
}

// 750 Hz and an amplitude of 0.25: bin 128, -12.04 dB.
TEST(Spectrum, SpectrumShowsASineAtItsFrequencyAndLevel) {
  std::vector<float> samples(10000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = static_cast<float>(0.25 * std::sin(2 * std::numbers::pi * 750 / 48000 * static_cast<double>(i)));
  }
  Spectrum spectrum;
  const auto levels = spectrum.analyse(samples);
  ASSERT_EQ(levels.size(), Spectrum::kFrames / 2 + 1);
  EXPECT_NEAR(levels[128], 20 * std::log10(0.25), 0.01);
  EXPECT_LT(levels[256], -100);
}

TEST(Spectrum, SpectrumOfSilenceIsTheFloor) {
  Spectrum spectrum;
  for (const float level : spectrum.analyse(std::vector<float>(100))) EXPECT_EQ(level, float(Spectrum::kFloor_db));
}

}  // namespace
}  // namespace ringdown::viewer
