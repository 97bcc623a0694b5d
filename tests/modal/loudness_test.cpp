// How loud modes are, by what a bank knows of them.
#include "engine/modal/hearing/loudness.h"

#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::modal {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

// A sphere of 60 rings with 120 points each, whose mode breathes: every point moves outward by 1 kg^-1/2.
Bank breathing_sphere(double radius_m, double frequency_hz) {
  Bank bank{.name = "sphere", .frequency_hz = {frequency_hz}, .decay_per_s = {1}};
  constexpr int kRings = 60, kAround = 120;
  const auto add = [&](double polar, double azimuth) {
    const Vec3 at{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
    const auto scaled = [&](double s) {
      return Vec3f{static_cast<float>(s * at.x), static_cast<float>(s * at.y), static_cast<float>(s * at.z)};
    };
    bank.positions.push_back(scaled(radius_m));
    bank.shapes.push_back(scaled(1));
    return static_cast<std::uint32_t>(bank.positions.size() - 1);
  };
  const std::uint32_t top = add(0, 0), bottom = add(M_PI, 0);
  for (int ring = 1; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) add(M_PI * ring / kRings, 2 * M_PI * i / kAround);
  }
  const auto at = [](int ring, int i) { return static_cast<std::uint32_t>(2 + (ring - 1) * kAround + i % kAround); };
  for (int i = 0; i < kAround; ++i) {
    bank.triangles.push_back({top, at(1, i), at(1, i + 1)});
    bank.triangles.push_back({bottom, at(kRings - 1, i + 1), at(kRings - 1, i)});
    for (int ring = 1; ring + 1 < kRings; ++ring) {
      bank.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
      bank.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
  }
  return bank;
}

// With the area 4 pi R^2 the disc of that area has the radius 2R, and the draft's formula is
// rho c R 2kR / sqrt(1 + (2kR)^2) at 1 m; a pulsating sphere has rho c R kR / sqrt(1 + (kR)^2).
TEST(Loudness, ASurfaceWithoutMapsSoundsByTheDraftsFormula) {
  const Air air;
  for (const double f : {50.0, 1000.0, 12000.0}) {
    const double radius_m = 0.1, kr = 2 * M_PI * f / air.sound_speed_m_s * radius_m;
    const Bank bank = breathing_sphere(radius_m, f);
    const double loud = Loudness(bank).pressure_pa(bank, 0, {}, f);
    const double drafts = air.density_kg_m3 * air.sound_speed_m_s * radius_m * 2 * kr / std::sqrt(1 + 4 * kr * kr);
    EXPECT_NEAR(loud / drafts, 1, 2e-3) << f;
    const double exact = air.density_kg_m3 * air.sound_speed_m_s * radius_m * kr / std::sqrt(1 + kr * kr);
    EXPECT_LT(std::abs(20 * std::log10(loud / exact)), 6.1) << "never more than an octave's worth";
  }
}

TEST(Loudness, AModeWithAMapSoundsByItsFarField) {
  Bank bank = breathing_sphere(0.1, 500);
  bank.radiation = BankRadiation{.maps = {.modes = {even_field(500)}}, .air = {.density_kg_m3 = 1}};
  const double expected = 2 * M_PI * 500 * rms(even_field(500));
  EXPECT_NEAR(Loudness(bank).pressure_pa(bank, 0, {}, 500), expected, 1e-9 * expected);
}

TEST(Loudness, ALargerBodyOfTheSameShapeIsAsLoudByEitherLaw) {
  Bank bank = breathing_sphere(0.1, 500);
  const auto ratio = [&] {
    const Loudness loudness(bank);
    return loudness.pressure_pa(bank, 0, {.size = 4}, 125) / loudness.pressure_pa(bank, 0, {}, 500);
  };
  // omega is a quarter, F twice as large
  EXPECT_NEAR(ratio(), 0.5, 1e-6);
  bank.radiation = BankRadiation{.maps = {.modes = {even_field(500)}}};
  EXPECT_NEAR(ratio(), 0.5, 1e-6);
  bank.radiation.reset();
  bank.triangles.clear();
  EXPECT_NEAR(ratio(), 0.5, 1e-6);
}

}  // namespace
}  // namespace ringdown::modal
