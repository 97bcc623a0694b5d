// Modes of the air in a tube, against closed forms.
#include "engine/tube/line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

namespace ringdown::tube::line_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius_m = 0.02, kLength_m = 0.372;
const modal::Air kAir;

// A mouth in free air.
Outside free_mouth(double frequency_hz) {
  const double k = 2 * kPi * frequency_hz / kAir.sound_speed_m_s;
  return {{-kFreeEnd * kRadius_m, -k * kRadius_m * kRadius_m / 4}, k};
}

// With `share` of the losses at the wall: a wider tube of the same proportions has less of them.
TEST(Line, StoppedTubeRingsAtAQuarterOfAWave) {
  constexpr double kWide = 1000;  // boundary layers are then thin beside it
  Outside outside = free_mouth(220);
  outside.end_m *= kWide;
  outside.end_m.imag(0);
  outside.wavenumber_rad_m /= kWide;
  const Line line{kWide * kRadius_m, kWide * kLength_m};
  const double expected = kPi * kAir.sound_speed_m_s / (2 * kWide * (kLength_m + kFreeEnd * kRadius_m));
  for (const int n : {0, 1, 2}) {
    const auto mode = tube_mode(line, outside, kAir, partial_rad_s(line, kWide * kFreeEnd * kRadius_m, kAir, n));
    ASSERT_TRUE(mode);
    // A real end correction is not a longer tube: k E in place of tan(k E), 2e-3 of the third partial.
    EXPECT_NEAR(mode->omega_rad_s.real() / ((2 * n + 1) * expected), 1, 3e-3);
  }
}

TEST(Line, OpenTubeRingsAtHalfAWave) {
  const Line line{kRadius_m, kLength_m, false};
  const double ends_m = kLength_m + 2 * kFreeEnd * kRadius_m;
  const double lossless_hz = kAir.sound_speed_m_s / (2 * ends_m);
  const auto mode = tube_mode(line, free_mouth(lossless_hz), kAir, 2 * kPi * lossless_hz);
  ASSERT_TRUE(mode);
  // The layers at the wall slow the wave by half of 1 / Q of the wall.
  EXPECT_NEAR(mode->omega_rad_s.real() / (2 * kPi * lossless_hz), 1, 0.006);
}

// 1/Q = 1/Q_rad + 1/Q_wall, Q_wall by Kirchhoff for layers thin beside the radius, Q_rad of a simple source.
TEST(Line, QualityIsThatOfWallAndRadiation) {
  const Outside outside = free_mouth(220);
  const Line line{kRadius_m, kLength_m};
  const auto mode = tube_mode(line, outside, kAir, 2 * kPi * 220);
  ASSERT_TRUE(mode);
  const double omega = mode->omega_rad_s.real(), k = omega / kAir.sound_speed_m_s;
  const double whole_m = kPi / (2 * k), area_m2 = kPi * kRadius_m * kRadius_m;
  const double layer_m = std::sqrt(2 * 1.506e-5 / omega);
  const double q_radiated = 2 * kPi * whole_m / (k * area_m2);
  const double q_wall = kRadius_m / (layer_m + 0.4 / std::sqrt(0.71) * layer_m) * whole_m / kLength_m;
  const double q = 1 / (1 / q_radiated + 1 / q_wall);
  EXPECT_NEAR(-omega / (2 * mode->omega_rad_s.imag()) / q, 1, 0.03);
  EXPECT_NEAR(q, 80, 2) << "the wall decides";
  EXPECT_NEAR(std::abs(mode->reach_m) / whole_m, 1, 0.02);
}

TEST(Line, TunedTubeRingsAtItsFrequency) {
  for (const bool stopped : {true, false}) {
    for (const int partial : {0, 1}) {
      const double omega = 2 * kPi * 220 * (partial + 1);
      const Outside outside = free_mouth(220 * (partial + 1));
      const auto length = length_for({kRadius_m, 0, stopped}, outside, kAir, partial, omega);
      ASSERT_TRUE(length);
      const auto mode = tube_mode({kRadius_m, *length, stopped}, outside, kAir, 0.97 * omega);
      ASSERT_TRUE(mode);
      EXPECT_NEAR(mode->omega_rad_s.real() / omega, 1, 1e-10);
    }
  }
  EXPECT_FALSE(length_for({kRadius_m, 0, true}, free_mouth(9000), kAir, 0, 2 * kPi * 9000)) << "shorter than wide";
}

}  // namespace
}  // namespace ringdown::tube::line_test
