// A body with pieces as its bank's file holds them, and damage to such files.
#pragma once

#include "engine/modal/fracture/fracture.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>

namespace ringdown::modal::fracture_file_test {

using test::GlbParts;
using test::Json;

inline constexpr std::size_t kModes = 9;
inline constexpr std::size_t kSilent = 1;  // of each pattern, the piece without modes

inline PieceBank piece_of(std::uint32_t seed, std::size_t modes) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> entry(-1, 1);
  PieceBank piece{.bank = ringdown::test::random_bank(seed, modes, 20), .near_m = 0.01 * seed, .far_m = 0.02 * seed};
  piece.bank.name = "body." + std::to_string(seed);
  piece.bank.radiation.reset();
  piece.bank.material = ringdown::test::bar_bank(1).material;
  piece.bank.mass = MassProperties{.mass_kg = 0.1 * seed,
                                   .center_of_mass_m = {0.1, 0.01 * seed, 0.3},
                                   .inertia_kg_m2 = {1e-4, 2e-4, 2.5e-4},
                                   .orientation = {0.5, -0.5, 0.5, 0.5}};
  for (std::size_t i = 0; i < (kRigidMotions + modes) * (kRigidMotions + kModes); ++i)
    piece.handover.push_back(entry(random));
  return piece;
}

// A body with two patterns, of two and of three pieces, one of each silent.
inline Bank breakable_bank() {
  Bank bank = ringdown::test::random_bank(4, kModes, 30);
  bank.name = "body";
  bank.material = ringdown::test::bar_bank(1).material;
  bank.mass = ringdown::test::bar_bank(1).mass;
  // As the file holds them, so that what is read can be compared for equality.
  Fracture fracture;
  fracture.patterns.push_back(
      {.at_m = {0.1, -0.2, 0.3}, .crack_area_m2 = 0.125, .pieces = {piece_of(1, 5), piece_of(2, 0)}});
  fracture.patterns.push_back(
      {.at_m = {-1, 0, 1e-3}, .crack_area_m2 = 0.5, .pieces = {piece_of(3, 4), piece_of(4, 0), piece_of(5, 7)}});
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
  return bank;
}

inline void expect_same_piece(const PieceBank& a, const PieceBank& b, bool exact_shapes) {
  EXPECT_EQ(a.bank.name, b.bank.name);
  ASSERT_EQ(a.bank.mode_count(), b.bank.mode_count());
  for (std::size_t m = 0; m < a.bank.mode_count(); ++m) {
    EXPECT_EQ(static_cast<float>(a.bank.frequency_hz[m]), static_cast<float>(b.bank.frequency_hz[m]));
    EXPECT_EQ(static_cast<float>(a.bank.decay_per_s[m]), static_cast<float>(b.bank.decay_per_s[m]));
  }
  EXPECT_EQ(a.bank.positions, b.bank.positions);
  EXPECT_EQ(a.bank.triangles, b.bank.triangles);
  if (exact_shapes) {
    EXPECT_EQ(a.bank.shapes, b.bank.shapes);
  } else {
    EXPECT_EQ(a.bank.shapes.size(), b.bank.shapes.size());
  }
  ASSERT_TRUE(b.bank.material && b.bank.mass);
  EXPECT_EQ(a.bank.material->name, b.bank.material->name);
  EXPECT_EQ(a.bank.material->density_kg_m3, b.bank.material->density_kg_m3);
  EXPECT_EQ(a.bank.mass->mass_kg, b.bank.mass->mass_kg);
  EXPECT_EQ(a.bank.mass->center_of_mass_m, b.bank.mass->center_of_mass_m);
  EXPECT_EQ(a.bank.mass->inertia_kg_m2, b.bank.mass->inertia_kg_m2);
  EXPECT_EQ(a.bank.mass->orientation, b.bank.mass->orientation);
  EXPECT_EQ(a.handover, b.handover);
  EXPECT_EQ(a.near_m, b.near_m);
  EXPECT_EQ(a.far_m, b.far_m);
  EXPECT_FALSE(b.bank.fracture);
}

// What is done to the parts of a good file, and a word of the sentence that must come of it.
struct Damage {
  const char* name;
  std::function<void(GlbParts&)> change;
  const char* expected;
};

inline Json& fracture_in(GlbParts& parts) { return parts.model()["extras"]["ringdown"]["fracture"]; }
inline Json& pattern_in(GlbParts& parts) { return fracture_in(parts)["patterns"][0]; }
inline Json& piece_in(GlbParts& parts, std::size_t number = 0) { return pattern_in(parts)["pieces"][number]; }

}  // namespace ringdown::modal::fracture_file_test
