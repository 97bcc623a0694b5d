#include "tests/support/keep_signals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace ringdown::test {
namespace {

std::string current_test() {
  const auto* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string name = info ? std::string(info->test_suite_name()) + "." + info->name() : "signal";
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

}  // namespace

KeepSignals::~KeepSignals() {
  if (!testing::Test::HasFailure() && !std::getenv("RINGDOWN_KEEP_SIGNALS")) return;
  std::error_code ignored;
  std::filesystem::create_directories(RINGDOWN_SIGNALS_DIR, ignored);
  for (const auto& [name, samples] : signals_) {
    const std::string path = std::string(RINGDOWN_SIGNALS_DIR) + "/" + current_test() + "." + name;
    write_wave(path + ".wav", samples, sample_rate_hz_);
    write_spectrum(path + ".csv", samples, sample_rate_hz_);
    std::printf("signal kept: %s.wav and .csv\n", path.c_str());
  }
}

// Canonical RIFF header, format 3 (IEEE float), one channel, 32 bits.
void write_wave(const std::string& path, std::span<const double> samples, double sample_rate_hz) {
  std::ofstream file(path, std::ios::binary);
  const auto word = [&file](std::uint32_t value) { file.write(reinterpret_cast<const char*>(&value), 4); };
  const auto half = [&file](std::uint16_t value) { file.write(reinterpret_cast<const char*>(&value), 2); };
  const auto bytes = static_cast<std::uint32_t>(4 * samples.size());
  const auto rate = static_cast<std::uint32_t>(std::lround(sample_rate_hz));
  file << "RIFF", word(36 + bytes), file << "WAVEfmt ", word(16);
  half(3), half(1), word(rate), word(4 * rate), half(4), half(32);
  file << "data", word(bytes);
  for (const double sample : samples) {
    const auto value = static_cast<float>(sample);
    file.write(reinterpret_cast<const char*>(&value), 4);
  }
}

void write_spectrum(const std::string& path, std::span<const double> samples, double sample_rate_hz) {
  std::ofstream file(path);
  file << "frequency_hz,level_db\n";
  if (samples.empty()) return;
  const Spectrum levels = spectrum(samples, sample_rate_hz);
  for (std::size_t k = 0; k < levels.magnitude.size(); ++k) {
    file << static_cast<double>(k) * levels.bin_hz << ',' << 20 * std::log10(levels.magnitude[k] + 1e-15) << '\n';
  }
}

}  // namespace ringdown::test
