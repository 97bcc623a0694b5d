// Maps of radiation: spherical harmonics against closed forms and sums, and what packing loses.
#include "engine/modal/radiation_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace ringdown::modal {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<float> harmonics_at(const Vec3& direction, int degree) {
  std::vector<float> values(harmonic_count(degree));
  real_harmonics(direction, degree, values);
  return values;
}

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return {normal(random), normal(random), normal(random)};
}

// A field of a given degree whose terms fall off as those of a vibrating body do.
FarField random_field(int degree, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<std::complex<double>> values(harmonic_count(degree));
  for (int l = 0; l <= degree; ++l) {
    for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
      values[i] = std::complex<double>(normal(random), normal(random)) * 1e-3 / (1.0 + l * l * l);
    }
  }
  FarField field;
  field.wavenumber_rad_m = 100;
  field.terms = terms_of(values);
  const auto own = static_cast<float>(rms(field));
  field.levels = {{50, own / 4}, {100, own}, {200, own * 3}};
  return field;
}

TEST(RadiationMap, HarmonicsOfDegreeTwoAreTheTextbookPolynomials) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 d = random_direction(random);
    const double r = length(d), x = d.x / r, y = d.y / r, z = d.z / r;
    const auto got = harmonics_at(d, 2);
    const double expected[] = {0.5 / std::sqrt(kPi),
                               std::sqrt(3 / (4 * kPi)) * y,
                               std::sqrt(3 / (4 * kPi)) * z,
                               std::sqrt(3 / (4 * kPi)) * x,
                               std::sqrt(15 / kPi) / 2 * x * y,
                               std::sqrt(15 / kPi) / 2 * y * z,
                               std::sqrt(5 / kPi) / 4 * (3 * z * z - 1),
                               std::sqrt(15 / kPi) / 2 * x * z,
                               std::sqrt(15 / kPi) / 4 * (x * x - y * y)};
    for (int h = 0; h < 9; ++h) EXPECT_NEAR(got[h], expected[h], 1e-6) << "harmonic " << h;
  }
}

// Unsoeld's theorem: the squares of one degree add up to (2l + 1) / (4 pi) in every direction.
TEST(RadiationMap, SquaresOfEachDegreeAddUpEverywhereUpToTheHighestDegree) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    const auto got = harmonics_at(i == 0 ? Vec3{0, 0, -3} : random_direction(random), kMaxHarmonicDegree);
    for (int l = 0; l <= kMaxHarmonicDegree; ++l) {
      double sum = 0;
      for (int h = l * l; h < (l + 1) * (l + 1); ++h) sum += static_cast<double>(got[h]) * got[h];
      EXPECT_NEAR(sum * 4 * kPi / (2 * l + 1), 1, 2e-5) << "degree " << l;
    }
  }
}

TEST(RadiationMap, RmsIsWhatAveragingOverDirectionsGives) {
  std::mt19937 random(3);
  const FarField field = random_field(6, random);
  double sum = 0;
  constexpr int kDirections = 20000;  // a spiral: each stands for the same solid angle
  for (int i = 0; i < kDirections; ++i) {
    const double z = -1 + 2 * (i + 0.5) / kDirections, phi = i * 2.399963229728653, r = std::sqrt(1 - z * z);
    sum += std::norm(far_field(field, harmonics_at({r * std::cos(phi), r * std::sin(phi), z}, 6)));
  }
  EXPECT_NEAR(rms(field) / std::sqrt(sum / kDirections), 1, 1e-3);
}

// A point source of volume velocity Q: F = -Q / (4 pi), power rho omega^2 Q^2 / (8 pi c).
TEST(RadiationMap, PowerOfAMonopoleIsTheTextbooks) {
  const double flow = 0.003, omega = 2500;
  const double y0 = 0.5 / std::sqrt(kPi);
  const std::complex<double> value = -flow / (4 * kPi) / y0;
  FarField field;
  field.terms = terms_of(std::span(&value, 1));
  const Air air;
  const double expected = air.density_kg_m3 * omega * omega * flow * flow / (8 * kPi * air.sound_speed_m_s);
  EXPECT_NEAR(radiated_power(rms(field), omega, air) / expected, 1, 1e-6);
}

TEST(RadiationMap, PackingLosesNoMoreThanOnePercent) {
  std::mt19937 random(4);
  RadiationMaps maps;
  maps.origin_m = {0.1, -0.2, 0.3};
  for (int m = 0; m < 40; ++m) maps.modes.push_back(random_field(m % 12, random));
  const PackedMaps packed = pack(maps);
  EXPECT_LE(packed.bytes.size(), 40 * kMaxPackedBytesPerMode + 32);
  EXPECT_LE(packed.largest_error, kPackingError);
  const auto read = unpack(packed.bytes, "test");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->modes.size(), maps.modes.size());
  EXPECT_NEAR(read->origin_m.y, -0.2, 1e-7);
  for (std::size_t m = 0; m < maps.modes.size(); ++m) {
    double lost = 0, all = 0;
    for (int i = 0; i < 200; ++i) {
      const auto at = harmonics_at(random_direction(random), 12);
      lost += std::norm(far_field(read->modes[m], at) - far_field(maps.modes[m], at));
      all += std::norm(far_field(maps.modes[m], at));
    }
    EXPECT_LT(std::sqrt(lost / all), 1.5 * kPackingError) << "mode " << m;
    EXPECT_NEAR(level_ratio(read->modes[m], 200), 3, 0.01);
  }
}

TEST(RadiationMap, PackingKeepsToItsBytesAndStatesTheError) {
  std::mt19937 random(5);
  RadiationMaps maps;
  for (int m = 0; m < 10; ++m) maps.modes.push_back(random_field(40, random));
  const PackedMaps all = pack(maps, std::size_t{1} << 20), fewer = pack(maps, 2000);
  EXPECT_GT(all.bytes.size(), 2000u);
  EXPECT_LE(fewer.bytes.size(), 2000u);
  EXPECT_GT(fewer.largest_error, all.largest_error);
  EXPECT_TRUE(unpack(fewer.bytes, "test"));
}

TEST(RadiationMap, LevelsAreInterpolatedAsPowersOfTheWavenumber) {
  std::mt19937 random(6);
  const FarField field = random_field(2, random);  // falls to a quarter one octave below: a square
  EXPECT_NEAR(level_ratio(field, 100), 1, 1e-6);
  EXPECT_NEAR(level_ratio(field, 100 / std::numbers::sqrt2), 0.5, 1e-5);
  EXPECT_NEAR(level_ratio(field, 25), 0.25, 1e-5) << "outside of the range the nearest level counts";
  EXPECT_TRUE(covers(field, 50) && covers(field, 200));
  EXPECT_FALSE(covers(field, 45) || covers(field, 220));
}

TEST(RadiationMap, DamagedBytesAreRefusedOrReadAsSoundMaps) {
  std::mt19937 random(7);
  RadiationMaps maps;
  for (int m = 0; m < 3; ++m) maps.modes.push_back(random_field(5, random));
  const std::vector<std::byte> bytes = pack(maps).bytes;
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) EXPECT_FALSE(unpack(std::span(bytes).first(cut), "test")) << cut;
  for (int trial = 0; trial < 3000; ++trial) {
    auto damaged = bytes;
    damaged[random() % damaged.size()] = static_cast<std::byte>(random());
    const auto read = unpack(damaged, "test");
    if (!read) continue;
    for (const FarField& field : read->modes) EXPECT_LE(degree_of(field), kMaxHarmonicDegree);
  }
}

}  // namespace
}  // namespace ringdown::modal
