// The bar of the previews against thin beams' closed form and against the finite elements it does without.
#include "engine/materials/material_bar.h"

#include "engine/bake/bake.h"
#include "engine/materials/material_library.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ringdown::material_bar_test {
namespace {

const modal::Material kSteel = {"steel", 210e9, 0.31, 7800, {5, 3e-8}};

// Euler and Bernoulli: f = (k L)^2 / (2 pi L^2) sqrt(E I / (rho A)), k L the roots of cos cosh = 1.
TEST(MaterialBar, TheBarIsEulersBeamWhereItIsThin) {
  const bake::Bar thin{.length_m = 2, .width_m = 0.01, .thickness_m = 0.001};
  const auto lambdas = bake::bar_lambdas(kSteel, thin, std::pow(2 * M_PI * 200, 2));
  const double roots[] = {4.730040745, 7.853204624, 10.99560784, 14.13716549, 17.27875966};
  ASSERT_GE(lambdas.size(), 5u);
  for (int n = 0; n < 5; ++n) {
    const double omega = std::pow(roots[n] / 2, 2) * std::sqrt(210e9 * std::pow(0.001, 2) / 12 / 7800);
    EXPECT_NEAR(std::sqrt(lambdas[n]) / omega, 1, 1e-4) << n;
  }
}

// Modes of a solid bar whose upper face moves along z, no more at its edges than in its middle, bend it across its
// thickness.
std::vector<double> bending_hz(const modal::Bank& bank, float thickness_m) {
  std::vector<double> found;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    double across = 0, all = 0, at_edges = 0;
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const auto& s = bank.shape(m, p);
      if (std::abs(bank.positions[p][2] - thickness_m) > 1e-4f) continue;
      across += s[2] * s[2];
      all += s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
      const double side = (bank.positions[p][1] - 0.015) / 0.015;
      at_edges += side * side * s[2] * s[2];
    }
    if (across > 0.8 * all && at_edges < 0.55 * across) found.push_back(bank.frequency_hz[m]);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(MaterialBar, TheBarIsASolidBarToOnePercentUntilHalfAWaveIsAsShortAsItsWidth) {
  const mesh::CheckedMesh mesh = test::checked(test::box_mesh({16, 3, 1}, {0.2, 0.03, 0.008}));
  const auto baked = bake::bake(mesh, kSteel, {.band_high_hz = 12000, .points = 100'000}, "bar");
  ASSERT_TRUE(baked) << baked.error().message;
  const modal::Bank bar = bake::bar_bank(kSteel);
  const std::vector<double> solid = bending_hz(baked->bank, 0.008f);
  ASSERT_GE(solid.size(), 4u);
  for (std::size_t n = 0; n < 4; ++n) EXPECT_NEAR(bar.frequency_hz[n] / solid[n], 1, 0.01) << solid[n];
}

TEST(MaterialBar, TheBarMovesNoMoreThanItsMassAllows) {
  const modal::Bank bar = bake::bar_bank(kSteel);
  const double mass = 7800 * 0.2 * 0.03 * 0.008;
  EXPECT_NEAR(bar.mass->mass_kg, mass, 1e-12);
  ASSERT_GE(bar.mode_count(), 5u);
  const auto at = [&](std::size_t m, int p) {
    return static_cast<double>(bar.shape(m, static_cast<std::size_t>(p))[2]);
  };
  for (std::size_t m = 0; m < 5; ++m) {
    EXPECT_NEAR(at(m, bake::kBarPoints - 1), (m % 2 == 0 ? 1 : -1) * at(m, 0), 1e-4) << "even and odd by turns";
    double mean = 0;
    for (int p = 0; p < bake::kBarPoints; ++p) {
      const double weight = p == 0 || p == bake::kBarPoints - 1 ? 0.5 : 1;
      mean += weight * at(m, p) * at(m, p) / (bake::kBarPoints - 1);
    }
    EXPECT_LT(mean * mass, 1) << "turning sections have a share of the energy";
    EXPECT_GT(mean * mass, 0.85) << m;
  }
  EXPECT_NEAR(std::abs(at(0, 0)) * std::sqrt(mass), 2, 0.05) << "the end of a thin free bar: 2 / sqrt(m)";
}

TEST(MaterialBar, ABarOfEveryPresetRingsOrSaysThatItDoesNot) {
  const std::filesystem::path folder = std::filesystem::path(RINGDOWN_SOURCE_DIR) / "presets/materials";
  EXPECT_GE(bake::names_in(folder).size(), 20u);
  for (const auto& materials : {folder, folder / "report-2011"}) {
    for (const std::string& name : bake::names_in(materials)) {
      const auto entry = bake::read_material(materials / (name + ".toml"));
      ASSERT_TRUE(entry) << entry.error().message;
      const modal::Bank bar = bake::bar_bank(entry->material);
      EXPECT_GE(bar.mode_count(), 3u) << name;
      for (const double f : bar.frequency_hz) EXPECT_TRUE(f > 50 && f < 20000) << name << " " << f;
    }
  }
}

TEST(MaterialBar, ABarThatIsAllDampingIsEmpty) {
  EXPECT_EQ(bake::bar_bank({"mud", 1e6, 0.4, 1500, {0, 1}}).mode_count(), 0u);
}

}  // namespace
}  // namespace ringdown::material_bar_test
