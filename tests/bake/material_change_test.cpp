// A rescaled bank is the bank that would have been baked, from a mesh scaled by hand and in the other material.
#include "engine/materials/material_change.h"

#include "engine/bake/bake.h"
#include "engine/modal/fracture/fracture.h"
#include "tests/fem/sample_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

namespace ringdown::material_change_test {
namespace {

const modal::Material kSteel = {"steel", 200e9, 0.3, 7850, {5, 3e-8}}, kOther = {"other", 61e9, 0.3, 1930, {0.3, 2e-7}};

// Three unlike edges, off the origin. All points of the surface: which of them a smaller bank keeps is up to rounding.
modal::Bank baked(double size, const modal::Material& material, double high_hz,
                  const std::optional<bake::Grain>& grain = {}) {
  mesh::TetMesh mesh = test::box_mesh({8, 2, 2}, size * Eigen::Vector3d(0.2, 0.025, 0.011));
  mesh.nodes.col(1).array() += 0.1 * size;
  bake::BakeOptions options{.band_low_hz = 20, .band_high_hz = high_hz, .points = 100'000};
  options.makeup.grain = grain;
  return bake::bake(test::checked(mesh), material, options, "bar").value().bank;
}

std::vector<std::size_t> by_pitch(const modal::Bank& bank) {
  std::vector<std::size_t> order(bank.mode_count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t m) { return bank.frequency_hz[m]; });
  return order;
}

void expect_same(const modal::Bank& a, const modal::Bank& b, double relative) {
  ASSERT_EQ(a.mode_count(), b.mode_count());
  ASSERT_EQ(a.point_count(), b.point_count());
  const auto order_a = by_pitch(a), order_b = by_pitch(b);
  for (std::size_t i = 0; i < a.mode_count(); ++i) {
    const std::size_t m = order_a[i], n = order_b[i];
    EXPECT_NEAR(a.frequency_hz[m] / b.frequency_hz[n], 1, relative);
    EXPECT_NEAR(a.decay_per_s[m] / b.decay_per_s[n], 1, relative);
    float largest = 0, off = 0;
    for (std::size_t p = 0; p < a.point_count(); ++p) {
      for (int k = 0; k < 3; ++k) {
        largest = std::max(largest, std::abs(b.shape(n, p)[k]));
        off = std::max(off, std::abs(a.shape(m, p)[k] - b.shape(n, p)[k]));
      }
    }
    EXPECT_LT(off, 10 * relative * largest) << a.frequency_hz[m];
  }
  for (std::size_t p = 0; p < a.point_count(); ++p) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.positions[p][k], b.positions[p][k], 1e-6);
  }
  EXPECT_NEAR(a.mass->mass_kg / b.mass->mass_kg, 1, relative);
  EXPECT_NEAR(a.mass->center_of_mass_m.y / b.mass->center_of_mass_m.y, 1, relative);
  EXPECT_NEAR(a.mass->inertia_kg_m2.x / b.mass->inertia_kg_m2.x, 1, relative);
  EXPECT_EQ(a.material->damping, b.material->damping);
  EXPECT_EQ(a.material->youngs_modulus_pa, b.material->youngs_modulus_pa);
}

TEST(Change, AChangeOfSizeIsABakeOfTheMeshScaledByHand) {
  const modal::Bank one = baked(1, kSteel, 16000);
  for (const double size : {2.0, 0.61}) {
    const auto changed = bake::change(one, {.size = size});
    ASSERT_TRUE(changed) << changed.error().message;
    const double high_hz = changed->bank.provenance.band_high_hz;
    EXPECT_NEAR(high_hz, 16000 / size, 100);
    EXPECT_NEAR(changed->bank.provenance.band_low_hz, 20 / size, 0.1);
    expect_same(changed->bank, baked(size, kSteel, high_hz), 1e-6);
  }
}

TEST(Change, AStatedPitchChangesAsTheModesDo) {
  modal::Bank bar = baked(1, kSteel, 4000);
  EXPECT_FALSE(bake::change(bar, {.size = 2})->bank.pitch_hz) << "nothing was stated";
  bar.pitch_hz = 220;
  EXPECT_DOUBLE_EQ(bake::change(bar, {.size = 2})->bank.pitch_hz.value_or(0), 110);
  modal::Material light = kSteel;
  light.density_kg_m3 /= 4;
  EXPECT_NEAR(bake::change(bar, {.material = light})->bank.pitch_hz.value_or(0), 440, 1e-9);
}

TEST(Change, AChangeOfMaterialIsABakeInIt) {
  const modal::Bank one = baked(1, kSteel, 16000);
  const auto changed = bake::change(one, {.size = 1.3, .material = kOther});
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->bank.material->name, "other");
  expect_same(changed->bank, baked(1.3, kOther, changed->bank.provenance.band_high_hz), 1e-6);
}

// Each mode keeps its own share of losses along the grain and across it. Which modes end the band is up to their
// losses, so those below are compared.
TEST(Change, ABodyWithAGrainChangesSizeAndMaterialAsABakeDoes) {
  const bake::Grain grain{.along = {1, 0, 0}, .radial = Vec3{0, 0, 1}};
  modal::Material spruce = {"spruce", 11e9, 0.3, 430, {0, 4e-6}};
  spruce.orthotropy = modal::Orthotropy{.youngs_modulus_pa = {11e9, 0.86e9, 0.47e9},
                                        .poisson_ratio = {0.37, 0.47, 0.44},
                                        .shear_modulus_pa = {0.70e9, 0.67e9, 0.033e9},
                                        .loss = {1, 2.5, 2.5, 2, 2, 2.5}};
  modal::Material stiffer = spruce;
  stiffer.youngs_modulus_pa *= 1.4;
  stiffer.orthotropy = modal::stiffer(*spruce.orthotropy, 1.4);
  stiffer.density_kg_m3 = 510;
  stiffer.damping.beta_s = 2e-6;
  const modal::Bank one = baked(1, spruce, 14000, grain);
  const auto changed = bake::change(one, {.size = 1.3, .material = stiffer});
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_EQ(changed->bank.material->orthotropy, stiffer.orthotropy);
  const modal::Bank other = baked(1.3, stiffer, changed->bank.provenance.band_high_hz, grain);
  const auto order_a = by_pitch(changed->bank), order_b = by_pitch(other);
  const std::size_t count = std::min(order_a.size(), order_b.size()) - 2;
  ASSERT_GE(count, 10u);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_NEAR(changed->bank.frequency_hz[order_a[i]] / other.frequency_hz[order_b[i]], 1, 1e-6) << i;
    EXPECT_NEAR(changed->bank.decay_per_s[order_a[i]] / other.decay_per_s[order_b[i]], 1, 1e-5) << i;
  }
}

TEST(Change, AChangeToALossFactorOfEachFrequencyAndBackIsABakeInIt) {
  modal::Material listed = kOther;
  listed.loss_factors = {{300, 0.02}, {3000, 0.004}, {9000, 0.01}};
  listed.damping = modal::fit_rayleigh(listed.loss_factors);
  const modal::Bank one = baked(1, kSteel, 16000);
  const auto changed = bake::change(one, {.size = 1.3, .material = listed});
  ASSERT_TRUE(changed);
  const modal::Bank other = baked(1.3, listed, changed->bank.provenance.band_high_hz);
  expect_same(changed->bank, other, 1e-6);
  for (std::size_t m = 0; m < other.mode_count(); ++m) {
    const double f = std::sqrt(modal::undamped_lambda({other.frequency_hz[m], other.decay_per_s[m]})) / (2 * M_PI);
    EXPECT_NEAR(other.decay_per_s[m], M_PI * f * modal::loss_factor_at(listed.loss_factors, f), 1e-6 * f);
  }
  const auto back = bake::change(changed->bank, {.size = 1 / 1.3, .material = kSteel});
  ASSERT_TRUE(back);
  expect_same(back->bank, one, 1e-6);
}

// A body of two pieces, one with modes; its handover of mode k from mode j is 0.01 k + 0.001 j.
modal::Bank breaking_bar() {
  static const modal::Bank whole = baked(1, kSteel, 16000), half = baked(0.5, kSteel, 16000);
  modal::Bank bar = whole;
  modal::PieceBank piece{.bank = half}, silent{.bank = {.mass = piece.bank.mass}};
  const std::size_t columns = modal::kRigidMotions + bar.mode_count();
  for (std::size_t k = 0; k < modal::kRigidMotions + piece.bank.mode_count(); ++k) {
    for (std::size_t j = 0; j < columns; ++j) piece.handover.push_back(0.01F * k + 0.001F * j);
  }
  silent.handover.assign(modal::kRigidMotions * columns, 0.5F);
  modal::Fracture fracture{.skin_m2 = 0.02, .strength = modal::Strength{4e7, 6}, .crack_energy_j_m2 = 8};
  fracture.patterns.push_back({.crack_area_m2 = 1e-4, .pieces = {piece, silent}});
  bar.fracture = std::make_shared<const modal::Fracture>(fracture);
  return bar;
}

TEST(Change, PiecesChangeAsTheBodyDoes) {
  modal::Material brittle = kOther;
  brittle.brittleness = {.strength = {5e7, 9, 1e-4}, .toughness_pa_sqrt_m = 1e6};
  const modal::Bank one = breaking_bar();
  const auto changed = bake::change(one, {.size = 1.3, .material = brittle});
  ASSERT_TRUE(changed) << changed.error().message;
  const modal::Fracture &before = *one.fracture, &after = *changed->bank.fracture;
  EXPECT_NEAR(after.skin_m2, 1.69 * before.skin_m2, 1e-12);
  EXPECT_EQ(after.strength.value().strength_pa, 5e7);
  EXPECT_NEAR(after.crack_energy_j_m2, 1e12 * 0.91 / 61e9, 1e-9);
  const modal::PieceBank &from = before.patterns[0].pieces[0], &to = after.patterns[0].pieces[0];
  const double high_hz = to.bank.provenance.band_high_hz;
  expect_same(to.bank, baked(0.65, kOther, high_hz), 1e-6);
  EXPECT_NEAR(after.patterns[0].pieces[1].bank.mass->mass_kg, to.bank.mass->mass_kg, 1e-12);
  // Rows and columns follow the modes to their new places, which their frequencies tell.
  const auto places = [](const modal::Bank& old, const modal::Bank& now) {
    std::vector<std::size_t> place(old.mode_count());
    const auto order_old = by_pitch(old), order_now = by_pitch(now);
    for (std::size_t i = 0; i < place.size(); ++i) place[order_now[i]] = order_old[i];
    return place;
  };
  ASSERT_EQ(to.bank.mode_count(), from.bank.mode_count());
  ASSERT_EQ(changed->bank.mode_count(), one.mode_count());
  const auto rows = places(from.bank, to.bank), columns = places(one, changed->bank);
  const std::size_t width = modal::kRigidMotions + columns.size();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t j = 0; j < columns.size(); ++j)
      EXPECT_EQ(to.handover[(modal::kRigidMotions + k) * width + modal::kRigidMotions + j],
                from.handover[(modal::kRigidMotions + rows[k]) * width + modal::kRigidMotions + columns[j]]);
  }
}

TEST(Change, ABodyThatIsMadeOfADuctileMaterialHasNoStrength) {
  const auto changed = bake::change(breaking_bar(), {.material = kOther});
  ASSERT_TRUE(changed) << changed.error().message;
  EXPECT_FALSE(changed->bank.fracture->strength);
  EXPECT_EQ(changed->bank.fracture->crack_energy_j_m2, 0);
  const auto larger = bake::change(breaking_bar(), {.size = 2});
  EXPECT_EQ(larger->bank.fracture->strength.value().strength_pa, 4e7) << "the material stays";
  EXPECT_EQ(larger->bank.fracture->crack_energy_j_m2, 8);
}

TEST(Change, AChangeOrdersModesByTheirNewImportanceAndBackIsTheOldBank) {
  const modal::Bank one = baked(1, kSteel, 16000);
  const auto there = bake::change(one, {.size = 8, .material = kOther});
  ASSERT_TRUE(there);
  EXPECT_NE(by_pitch(there->bank), by_pitch(one)) << "what was audible is so no more";
  const auto back = bake::change(there->bank, {.size = 0.125, .material = kSteel});
  ASSERT_TRUE(back);
  expect_same(back->bank, one, 1e-6);
  EXPECT_NEAR(back->bank.provenance.band_high_hz, 16000, 1e-3);
}

TEST(Change, AMaterialChangesFromNoDampingAndToNone) {
  modal::Material lossless = kSteel;
  lossless.damping = {};
  const auto damped = bake::change(baked(1, lossless, 16000), {.material = kSteel});
  ASSERT_TRUE(damped);
  expect_same(damped->bank, baked(1, kSteel, damped->bank.provenance.band_high_hz), 1e-6);
  const auto freed = bake::change(damped->bank, {.material = lossless});
  ASSERT_TRUE(freed);
  for (const double decay : freed->bank.decay_per_s) EXPECT_NEAR(decay, 0, 1e-9);
}

TEST(Change, AChangeLeavesOutWhatNoLongerRingsAndRefusesWhatItCannotKnow) {
  const modal::Bank one = baked(1, kSteel, 16000);
  modal::Material mud = kSteel;
  mud.damping.beta_s = 2e-4;
  const auto changed = bake::change(one, {.material = mud});
  ASSERT_TRUE(changed);
  EXPECT_GT(changed->over_damped, 0u);
  EXPECT_EQ(changed->bank.mode_count() + changed->over_damped, one.mode_count());
  mud.damping.beta_s = 1;
  EXPECT_FALSE(bake::change(one, {.material = mud}));
  modal::Bank nameless = one;
  nameless.material.reset();
  EXPECT_FALSE(bake::change(nameless, {.material = kOther}));
  EXPECT_TRUE(bake::change(nameless, {.size = 2}));
}

}  // namespace
}  // namespace ringdown::material_change_test
