// Filters of a head, against the responses that its SOFA file holds, which are read here without interpolation.
#include "server/session/head.h"

#include "tests/support/signal.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <mysofa.h>

#include <array>
#include <cmath>
#include <complex>
#include <fstream>
#include <numbers>
#include <vector>

namespace ringdown::session {
namespace {

constexpr double kHeadRate_hz = 44100;  // that of the file: nothing is resampled
constexpr const char* kHeadFile = "/usr/share/libmysofa/default.sofa";

using Ears = std::array<std::vector<double>, 2>;

Vec3 towards(double azimuth_degrees, double elevation_degrees) {
  const double a = azimuth_degrees * std::numbers::pi / 180, e = elevation_degrees * std::numbers::pi / 180;
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

// What the ears get of a unit impulse from a direction, by filters.
Ears response(const synth::HeadFilters& filters, Vec3 direction) {
  const synth::AmbisonicGains gains = synth::encode(direction);
  Ears ears;
  for (std::size_t e = 0; e < 2; ++e) {
    ears[e].resize(filters.taps);
    for (std::size_t n = 0; n < filters.taps; ++n) {
      for (std::size_t c = 0; c < gains.size(); ++c) {
        ears[e][n] += gains[c] * filters.reversed[e][(c + 1) * filters.taps - 1 - n];
      }
    }
  }
  return ears;
}

Ears measured(Vec3 direction) {
  static int taps = 0, error = 0;
  static MYSOFA_EASY* const sofa = mysofa_open_cached(kHeadFile, kHeadRate_hz, &taps, &error);
  EXPECT_NE(sofa, nullptr);
  const auto length = static_cast<std::size_t>(taps);
  std::array<std::vector<float>, 2> ears{std::vector<float>(length), std::vector<float>(length)};
  std::array<float, 2> delays{};
  mysofa_getfilter_float_nointerp(sofa, static_cast<float>(direction.x), static_cast<float>(direction.y),
                                  static_cast<float>(direction.z), ears[0].data(), ears[1].data(), &delays[0],
                                  &delays[1]);
  EXPECT_EQ(delays[0], delays[1]);
  return {test::to_doubles(ears[0]), test::to_doubles(ears[1])};
}

// Mean level between two frequencies.
double level_db(const std::vector<double>& wave, double low_hz, double high_hz) {
  double energy = 0;
  int count = 0;
  for (double f = low_hz; f <= high_hz; f += 86.1, ++count) {
    std::complex<double> sum;
    for (std::size_t n = 0; n < wave.size(); ++n) {
      sum += wave[n] * std::polar(1.0, -2 * std::numbers::pi * f * static_cast<double>(n) / kHeadRate_hz);
    }
    energy += std::norm(sum);
  }
  return 10 * std::log10(energy / count);
}

// By how much the left ear hears later than the right one, from the phases between 200 and 600 Hz, where they are
// clear.
double later_on_the_left_s(const Ears& ears) {
  double weighted = 0, weights = 0;
  for (double f = 200; f <= 600; f += 25) {
    std::array<std::complex<double>, 2> at;
    for (std::size_t e = 0; e < 2; ++e) {
      for (std::size_t n = 0; n < ears[e].size(); ++n) {
        at[e] += ears[e][n] * std::polar(1.0, -2 * std::numbers::pi * f * static_cast<double>(n) / kHeadRate_hz);
      }
    }
    const std::complex<double> ratio = at[1] * std::conj(at[0]);
    weighted += f * std::arg(ratio) / (2 * std::numbers::pi);
    weights += f * f;
  }
  return weighted / weights;
}

class HeadFilters : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto head = read_head("");
    ASSERT_TRUE(head) << head.error().message;
    filters_ = (*head)(kHeadRate_hz);
    ASSERT_TRUE(filters_);
  }
  static std::shared_ptr<const synth::HeadFilters> filters_;
};
std::shared_ptr<const synth::HeadFilters> HeadFilters::filters_;

// Up to 0.79 ms at the sides, within a tenth of that.
TEST_F(HeadFilters, TimesBetweenTheEarsAreTheHeads) {
  for (const double azimuth : {-90.0, -45.0, 0.0, 30.0, 90.0, 135.0, 180.0}) {
    const double exact_s = later_on_the_left_s(measured(towards(azimuth, 0)));
    EXPECT_NEAR(later_on_the_left_s(response(*filters_, towards(azimuth, 0))), exact_s, 8e-5) << azimuth;
  }
  EXPECT_LT(later_on_the_left_s(response(*filters_, towards(90, 0))), -5e-4) << "the left ear hears it first";
}

// Levels in a band of each ear, beside those of the file: 1.5 dB where phases are kept, more above, where a field of
// order 3 is too coarse for a head.
TEST_F(HeadFilters, LevelsAtTheEarsAreTheHeads) {
  double low = 0, high = 0, offset = 0;
  int count = 0;
  const auto each = [&](const auto& compare) {
    for (const double elevation : {-30.0, 0.0, 40.0}) {
      for (double azimuth = 0; azimuth < 360; azimuth += 60) {
        const Vec3 at = towards(azimuth, elevation);
        const Ears ours = response(*filters_, at), exact = measured(at);
        for (std::size_t e = 0; e < 2; ++e) compare(ours[e], exact[e]);
      }
    }
  };
  each([&](const auto& ours, const auto& exact) {
    offset += level_db(ours, 300, 1500) - level_db(exact, 300, 1500);
    ++count;
  });
  offset /= count;  // filters have a loudness of their own
  each([&](const auto& ours, const auto& exact) {
    low += std::pow(level_db(ours, 300, 1500) - level_db(exact, 300, 1500) - offset, 2) / count;
    high += std::pow(level_db(ours, 3000, 9000) - level_db(exact, 3000, 9000) - offset, 2) / count;
  });
  RecordProperty("rms_low_db", std::to_string(std::sqrt(low)));
  RecordProperty("rms_high_db", std::to_string(std::sqrt(high)));
  EXPECT_LT(std::sqrt(low), 1.0);
  EXPECT_LT(std::sqrt(high), 3.0);
}

TEST_F(HeadFilters, BothEarsTogetherGetTheEnergyOfTheStereoMix) {
  double energy = 0;
  constexpr int kRows = 40;
  for (int i = 0; i < kRows; ++i) {
    const double z = -1 + (2.0 * i + 1) / kRows, r = std::sqrt(1 - z * z);
    for (int j = 0; j < 8; ++j) {
      const double turn = 2 * std::numbers::pi * j / 8;
      const Ears ears = response(*filters_, {r * std::cos(turn), r * std::sin(turn), z});
      for (const auto& ear : ears) {
        for (const double sample : ear) energy += sample * sample / (kRows * 8);
      }
    }
  }
  EXPECT_NEAR(energy, 1, 0.02);
}

TEST(Head, WhatIsNoSofaFileIsRefusedInOneSentence) {
  const test::TemporaryFolder folder;
  const auto missing = read_head(folder / "missing.sofa");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("missing.sofa"), std::string::npos);
  EXPECT_EQ(missing.error().kind, ErrorKind::bad_input) << "as a bank that is missing";
  std::ofstream(folder / "text.sofa") << "This is not a SOFA file.";
  const auto text = read_head(folder / "text.sofa");
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("text.sofa is not a SOFA file"), std::string::npos) << text.error().message;
}

}  // namespace
}  // namespace ringdown::session
