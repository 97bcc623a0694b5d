// The measuring instruments are tested before they judge anything.
#include "tests/support/keep_signals.h"
#include "tests/support/signal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace ringdown::test {
namespace {

Samples damped_sine(double frequency_hz, double decay_per_s, double amplitude, double phase, double rate,
                    std::size_t count) {
  Samples samples(count);
  for (std::size_t n = 0; n < count; ++n) {
    const double t = static_cast<double>(n) / rate;
    samples[n] = amplitude * std::exp(-decay_per_s * t) * std::sin(2 * std::numbers::pi * frequency_hz * t + phase);
  }
  return samples;
}

TEST(Signal, ADampedSinusoidIsFittedFromDoubleSamples) {
  for (const double frequency : {50.0, 440.0, 3000.0, 12345.6, 23000.0}) {
    for (const double decay : {0.1, 3.0, 60.0}) {
      const auto mode = fit_damped_sinusoid(damped_sine(frequency, decay, 0.3, 0.7, 48000, 24000), 48000);
      EXPECT_NEAR(mode.frequency_hz, frequency, 1e-7) << frequency << " " << decay;
      EXPECT_NEAR(mode.decay_per_s, decay, 1e-6) << frequency << " " << decay;
      EXPECT_NEAR(mode.amplitude(), 0.3, 1e-8);
      EXPECT_NEAR(std::atan2(mode.cosine, mode.sine), 0.7, 1e-7);
    }
  }
}

TEST(Signal, TheRelativeErrorOfSignalsIsInDecibels) {
  const Samples one = {1, 0, -1, 0}, off = {1.1, 0, -1.1, 0};
  EXPECT_NEAR(relative_error_db(off, one), -20, 1e-9);
  EXPECT_EQ(relative_error_db(one, one), -INFINITY);
}

TEST(Signal, TheSpectrumOfASineHasItsFrequencyAndLevel) {
  const Spectrum levels = spectrum(damped_sine(1500, 0, 0.5, 0, 48000, 8192), 48000);
  EXPECT_NEAR(levels.magnitude[256], 0.5, 1e-3);  // 1500 Hz is bin 256 of 8192
  EXPECT_LT(levels.magnitude[1024], 1e-6);
}

TEST(Signal, WaveAndSpectrumOfAFailedTestAreReadable) {
  const std::string base = (std::filesystem::temp_directory_path() / "ringdown-kept").string();
  const Samples tone = damped_sine(1000, 5, 0.5, 0, 48000, 1000);
  write_wave(base + ".wav", tone, 48000);
  write_spectrum(base + ".csv", tone, 48000);
  EXPECT_EQ(std::filesystem::file_size(base + ".wav"), 44u + 4 * 1000);
  std::ifstream table(base + ".csv");
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "frequency_hz,level_db");
  std::remove((base + ".wav").c_str());
  std::remove((base + ".csv").c_str());
}

}  // namespace
}  // namespace ringdown::test
