// What is dropped cannot be heard, and what it costs is what a rendering loses.
#include "engine/bake/audibility.h"

#include "engine/bake/bake.h"
#include "engine/modal/bank_file.h"
#include "tests/support/temporary_folder.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>
#include <span>

namespace ringdown::audibility_test {
namespace {

using modal::Bank;

// An octahedron: the outward normal at each of its six points is that point.
Bank octahedron() {
  Bank bank;
  bank.name = "octahedron";
  for (const float sign : {1.0f, -1.0f}) {
    for (int axis = 0; axis < 3; ++axis) {
      modal::Vec3f point{};
      point[static_cast<std::size_t>(axis)] = sign;
      bank.positions.push_back(point);
    }
  }
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::uint32_t x = octant & 1 ? 3 : 0, y = octant & 2 ? 4 : 1, z = octant & 4 ? 5 : 2;
    const bool mirrored = ((octant & 1) + (octant >> 1 & 1) + (octant >> 2 & 1)) % 2;
    bank.triangles.push_back(mirrored ? std::array{x, z, y} : std::array{x, y, z});
  }
  return bank;
}

// The standard's formula and the pulse's envelope, on their own feet.
double spectral_gain(double f) {
  const auto squared = [](long double x) { return x * x; };
  const long double f2 = squared(f);
  const long double a =
      squared(12194.217L) * squared(f2) /
      ((f2 + squared(20.598997L)) * std::sqrt((f2 + squared(107.65265L)) * (f2 + squared(737.86223L))) *
       (f2 + squared(12194.217L))) *
      std::pow(10.0L, 0.1L);
  return static_cast<double>(2 * M_PIl * f * a / (1 + squared(2 * f * 0.0003L)));
}

// Every mode radiates the same share of its acceleration, in all directions.
const modal::FarField kEven{.wavenumber_rad_m = 1, .terms = {{0, {1e-3F, 0}}}};

// A mode that starts `level_db` loud (A-weighted, 0 dB the reference) for a blow on each of the six points.
void add_mode(Bank& bank, double frequency_hz, double decay_per_s, std::array<double, 6> level_db) {
  if (!bank.radiation) bank.radiation.emplace();
  bank.radiation->maps.modes.push_back(kEven);
  bank.frequency_hz.push_back(frequency_hz);
  bank.decay_per_s.push_back(decay_per_s);
  for (std::size_t p = 0; p < 6; ++p) {
    const double along = std::pow(10.0, level_db[p] / 20) / spectral_gain(frequency_hz);
    modal::Vec3f shape = bank.positions[p];
    for (float& component : shape) component *= static_cast<float>(along);
    bank.shapes.push_back(shape);
  }
}
void add_mode(Bank& bank, double frequency_hz, double decay_per_s, double level_db) {
  add_mode(bank, frequency_hz, decay_per_s, {level_db, level_db, level_db, level_db, level_db, level_db});
}

std::vector<bool> heard(const Bank& bank, double floor_db = 60) { return bake::audible_modes(bank, floor_db); }

TEST(Audibility, BelowTheFloorEverywhereIsInaudible) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 5, 0);
  add_mode(bank, 6000, 5, -59.5);
  add_mode(bank, 6000, 5, -60.5);
  add_mode(bank, 6000, 5, {-90, -90, -90, -90, -90, -59.5});
  EXPECT_EQ(heard(bank), (std::vector{true, true, false, true}));
  EXPECT_EQ(heard(bank, 50), (std::vector{true, false, false, false}));
}

// 70 dB less of what moves the surface reaches the air: such a mode is as inaudible as one that hardly moves.
TEST(Audibility, AModeThatHardlyRadiatesIsInaudible) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 5, 0);
  add_mode(bank, 6000, 5, 0);
  EXPECT_EQ(heard(bank), (std::vector{true, true}));
  bank.radiation->maps.modes[1].terms[0].value *= static_cast<float>(std::pow(10.0, -70.0 / 20));
  EXPECT_EQ(heard(bank), (std::vector{true, false}));
}

TEST(Audibility, TheFloorIsBelowTheLoudestAtTheSamePoint) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 5, {0, 0, 0, 0, 0, -100});  // silent where the other still sounds
  add_mode(bank, 6000, 5, -90);
  EXPECT_EQ(heard(bank), (std::vector{true, true}));
}

// What starts quietly but rings long collects more than a click.
TEST(Audibility, LongModesBelowTheFloorOfAClickAreHeard) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 2000, 0);
  add_mode(bank, 6000, 1, -70);
  EXPECT_EQ(heard(bank), (std::vector{true, true}));
}

TEST(Audibility, AGlancingShapeIsNotStruck) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 5, 0);
  add_mode(bank, 6000, 5, 0);
  for (modal::Vec3f& shape : std::span(bank.shapes).last(6))
    shape = {shape[1], shape[2], shape[0]};  // across the normals
  EXPECT_EQ(heard(bank), (std::vector{true, false}));
}

TEST(Audibility, ALouderNeighbourMasks) {
  const auto neighbour_heard = [](double frequency_hz, double level_db, double decay_per_s = 5) -> bool {
    Bank bank = octahedron();
    add_mode(bank, 1000, 5, 0);
    add_mode(bank, frequency_hz, decay_per_s, level_db);
    EXPECT_TRUE(heard(bank)[0]);
    return heard(bank)[1];
  };
  EXPECT_TRUE(neighbour_heard(1003, -24)) << "its beats can be heard";
  EXPECT_FALSE(neighbour_heard(1003, -27));
  EXPECT_TRUE(neighbour_heard(1500, -45)) << "2.7 Bark off";
  EXPECT_FALSE(neighbour_heard(1150, -45)) << "1 Bark above";
  EXPECT_TRUE(neighbour_heard(860, -45)) << "1 Bark below: masking spreads upwards more";
  EXPECT_TRUE(neighbour_heard(1150, -45, 1)) << "the masker dies sooner";
  EXPECT_FALSE(neighbour_heard(1150, -45, 50));
}

TEST(Audibility, AModeMaskedAtAllPointsButOneStays) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 5, 0);
  add_mode(bank, 1003, 5, -40);
  EXPECT_EQ(heard(bank), (std::vector{true, false}));
  Bank other = octahedron();
  add_mode(other, 1000, 5, {0, 0, -20, 0, 0, 0});
  add_mode(other, 1003, 5, -40);
  EXPECT_EQ(heard(other), (std::vector{true, true}));
}

// An A-weighted recording of a blow, and of what is missing from it, sample by sample.
double rendered_energy(const Bank& bank, std::size_t first, std::size_t point) {
  constexpr double kRate_hz = 96000, kSeconds = 0.8;
  double energy = 0;
  for (int i = 0; i < static_cast<int>(kRate_hz * kSeconds); ++i) {
    double sample = 0;
    const double t = i / kRate_hz;
    for (std::size_t m = first; m < bank.mode_count(); ++m) {
      const modal::Vec3f shape = bank.shape(m, point), normal = bank.positions[point];
      const double along = std::inner_product(shape.begin(), shape.end(), normal.begin(), 0.0);
      sample += spectral_gain(bank.frequency_hz[m]) * along * std::exp(-bank.decay_per_s[m] * t) *
                std::sin(2 * M_PI * bank.frequency_hz[m] * t);
    }
    energy += sample * sample / kRate_hz;
  }
  return energy;
}

TEST(Loss, TheLossIsWhatARenderingLoses) {
  Bank bank = octahedron();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> octave(8, 12.5), decay(20, 200), level(-30, 0);
  for (int m = 0; m < 9; ++m) {
    std::array<double, 6> levels{};
    for (double& one : levels) one = level(random);
    add_mode(bank, std::exp2(octave(random)), decay(random), levels);
  }
  add_mode(bank, bank.frequency_hz.back() + 2, bank.decay_per_s.back(), -6);  // two that beat: their product counts
  for (const std::size_t kept : {1u, 5u, 8u, 9u}) {
    double worst = 0;
    for (std::size_t p = 0; p < 6; ++p) {
      worst = std::max(worst, rendered_energy(bank, kept, p) / rendered_energy(bank, 0, p));
    }
    EXPECT_NEAR(bake::loss_db(bank, kept), 10 * std::log10(worst), 0.01) << kept;
  }
}

TEST(Loss, TheLossOfNothingIsNoneAndOfUndampedModesIsFinite) {
  Bank bank = octahedron();
  add_mode(bank, 1000, 0, 0);
  add_mode(bank, 3000, 0, -20);
  EXPECT_LE(bake::loss_db(bank, 2), -300);
  EXPECT_NEAR(bake::loss_db(bank, 1), 10 * std::log10(0.01 / 1.01), 1e-3);
}

TEST(Reduce, ReducingOrdersSilentModesLastAndDropsThemOnlyWhenAsked) {
  Bank bank = octahedron();
  add_mode(bank, 2000, 5, -80);
  add_mode(bank, 1000, 5, 0);
  add_mode(bank, 5000, 6, -20);
  const Bank before = bank;
  EXPECT_EQ(bake::reduce(bank, {}).inaudible, 0);
  EXPECT_EQ(bank.frequency_hz, (std::vector<double>{1000, 5000, 2000}));
  EXPECT_EQ(bank.decay_per_s, (std::vector<double>{5, 6, 5}));
  for (std::size_t p = 0; p < 6; ++p) {
    EXPECT_EQ(bank.shape(0, p), before.shape(1, p));
    EXPECT_EQ(bank.shape(2, p), before.shape(0, p));
  }
  EXPECT_EQ(bank.provenance.dropped_modes, 0);
  EXPECT_EQ(bake::reduce(bank, {.floor_db = 70}).inaudible, 1);
  EXPECT_EQ(bank.mode_count(), 2u);
  EXPECT_EQ(bank.shapes.size(), 12u);
  EXPECT_EQ(bank.provenance.dropped_modes, 1);
  EXPECT_EQ(bank.provenance.floor_db, 70);
  EXPECT_NEAR(bank.provenance.loss_db, -80, 0.1);
}

TEST(Reduce, ReducingKeepsTheFirstOnesAndSaysWhatThatCosts) {
  Bank bank = octahedron();
  for (int m = 0; m < 5; ++m) add_mode(bank, 500 * std::exp2(m), 10, -10.0 * m);
  const double loss = bake::loss_db(bank, 3);
  const bake::Reduced reduced = bake::reduce(bank, {.keep = 3});
  EXPECT_EQ(reduced.unimportant, 2);
  EXPECT_EQ(reduced.inaudible, 0);
  EXPECT_EQ(bank.mode_count(), 3u);
  EXPECT_EQ(bank.provenance.floor_db, 0);
  EXPECT_EQ(bank.provenance.loss_db, loss);
  EXPECT_LT(loss, -28);
}

// The most that may be kept, and the floor, are below what has to stay.
TEST(Reduce, WhatAlwaysStaysKeepsItsPlaceHoweverSoft) {
  Bank bank = octahedron();
  for (const double level_db : {-80.0, -20.0, -90.0, 0.0, -10.0}) add_mode(bank, 1000 - level_db, 5, level_db);
  const std::vector<double> first = {1080, 1020, 1090};
  Bank few = bank, loud = bank, whole = bank;
  EXPECT_EQ(bake::reduce(few, {.keep = 2, .always = 3}).unimportant, 2);
  EXPECT_EQ(few.frequency_hz, first);
  EXPECT_EQ(bake::reduce(loud, {.floor_db = 5, .always = 3}).inaudible, 1);
  EXPECT_EQ(loud.frequency_hz, (std::vector<double>{1080, 1020, 1090, 1000}));
  EXPECT_EQ(bake::reduce(whole, {.always = 3}).kept, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

// From the mesh to the file: the modes that stay are those of the whole bank, and the file says the same when read.
TEST(Reduce, ABakedBankSaysWhatWasLeftOut) {
  const mesh::CheckedMesh bar = test::checked(test::box_mesh({12, 2, 2}, {0.2, 0.02, 0.01}));
  const modal::Material steel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}};
  const auto baked = [&](double floor_db, int keep) {
    return bake::bake(bar, steel, {.keep_modes = keep, .floor_db = floor_db}, "bar").value();
  };
  const bake::Baked whole = baked(0, 0), less = baked(15, 0), few = baked(15, 4);
  EXPECT_GT(less.report.inaudible, 0);
  EXPECT_EQ(less.bank.mode_count() + static_cast<std::size_t>(less.report.inaudible), whole.bank.mode_count());
  EXPECT_EQ(few.bank.mode_count(), 4u);
  EXPECT_EQ(few.bank.provenance.dropped_modes, few.report.inaudible + few.report.unimportant);
  EXPECT_GT(few.bank.provenance.loss_db, less.bank.provenance.loss_db);
  EXPECT_LT(less.bank.provenance.loss_db, -10);
  for (const double frequency : less.bank.frequency_hz) {
    EXPECT_NE(std::find(whole.bank.frequency_hz.begin(), whole.bank.frequency_hz.end(), frequency),
              whole.bank.frequency_hz.end());
  }
  const test::TemporaryFolder folder;
  const auto text_of = [&](const char* name) {
    std::ifstream file(folder.path() / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  for (const bake::Baked* bake : {&whole, &less, &few}) {
    ASSERT_TRUE(modal::write_bank(bake->bank, folder.path() / "a.glb"));
    const Bank read = modal::read_bank(folder.path() / "a.glb").value();
    EXPECT_EQ(read.provenance.dropped_modes, bake->bank.provenance.dropped_modes);
    EXPECT_EQ(read.provenance.floor_db, bake->bank.provenance.floor_db);
    EXPECT_EQ(read.provenance.loss_db, bake->bank.provenance.loss_db);
    ASSERT_TRUE(modal::write_bank(read, folder.path() / "b.glb"));
    EXPECT_TRUE(text_of("a.glb") == text_of("b.glb"));
  }
  EXPECT_EQ(text_of("a.glb").find("\"dropped\"") != std::string::npos, true);
}

}  // namespace
}  // namespace ringdown::audibility_test
