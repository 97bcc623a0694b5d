// Stress, strength and the energy of cracks in a bank's file: written, read, scaled, and refused if they are broken.
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/mode_choice.h"
#include "engine/modal/scaled_bank.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

namespace ringdown::modal::strength_file_test {
namespace {

using test::GlbParts;
using test::Json;
using test::parse;
using test::written;

constexpr std::size_t kModes = 9, kPoints = 5;

StressTable random_stress() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> entry(-1, 1);
  StressTable table;
  for (std::size_t p = 0; p < kPoints; ++p) table.positions.push_back({entry(random), entry(random), entry(random)});
  for (std::size_t m = 0; m < kModes; ++m) table.largest.push_back(std::pow(10.0F, static_cast<float>(m + 4)));
  for (std::size_t row = 0; row < 3 * kPoints; ++row) {
    for (const float largest : table.largest) table.stress.push_back(0.49F * largest * entry(random));
  }
  return table;
}

// A body of two pieces, which do not ring.
Bank brittle_bank() {
  Bank bank = ringdown::test::random_bank(4, kModes, 30);
  bank.material = ringdown::test::bar_bank(1).material;
  bank.mass = ringdown::test::bar_bank(1).mass;
  PieceBank piece{.bank = ringdown::test::random_bank(1, 0, 20),
                  .handover = std::vector<float>(kRigidMotions * (kRigidMotions + kModes), 0.5F),
                  .near_m = 0,
                  .far_m = 1};
  piece.bank.radiation.reset();
  piece.bank.material = bank.material;
  piece.bank.mass = bank.mass;
  Fracture fracture{.stress = random_stress(),
                    .skin_m2 = 0.03125,
                    .strength = Strength{6e7, 7, 2e-3},
                    .crack_energy_j_m2 = 8.25};
  fracture.patterns.push_back({.at_m = {}, .crack_area_m2 = 0.125, .pieces = {piece, piece}});
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
  return bank;
}

TEST(StrengthFile, StressStrengthAndCrackEnergyComeBack) {
  const Bank whole = brittle_bank();
  const Fracture& before = *whole.fracture;
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const auto bank = parse(written(brittle_bank(), compression));
    ASSERT_TRUE(bank) << bank.error().message;
    const Fracture& after = *bank->fracture;
    ASSERT_TRUE(after.strength);
    EXPECT_EQ(after.strength->strength_pa, 6e7);
    EXPECT_EQ(after.strength->weibull_modulus, 7);
    EXPECT_EQ(after.strength->reference_area_m2, 2e-3);
    EXPECT_EQ(after.skin_m2, 0.03125);
    EXPECT_EQ(after.crack_energy_j_m2, 8.25);
    EXPECT_EQ(after.stress.positions, before.stress.positions);
    EXPECT_EQ(after.stress.largest, before.stress.largest);
    ASSERT_EQ(after.stress.stress.size(), before.stress.stress.size());
    const double rounding = compression == Compression::none ? 0 : 1.0 / 1024;
    for (std::size_t i = 0; i < after.stress.stress.size(); ++i) {
      EXPECT_LE(std::abs(after.stress.stress[i] - before.stress.stress[i]),
                rounding * before.stress.largest[i % kModes])
          << i;
    }
    EXPECT_EQ(written(*bank, compression), written(brittle_bank(), compression)) << "a second trip changes nothing";
  }
}

TEST(StrengthFile, ABankOfADuctileBodyHasNoStrength) {
  Bank bank = brittle_bank();
  Fracture fracture = *bank.fracture;
  fracture.strength.reset();
  fracture.crack_energy_j_m2 = 0;
  fracture.stress = {};
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
  const auto back = parse(written(bank));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_FALSE(back->fracture->strength);
  EXPECT_EQ(back->fracture->crack_energy_j_m2, 0);
  EXPECT_TRUE(back->fracture->stress.positions.empty());
}

TEST(StrengthFile, ChosenModesTakeTheirStressAlong) {
  const Bank whole = brittle_bank();
  Bank few = whole;
  const std::vector<std::size_t> order = {7, 0, 3};
  take_modes(few, order);
  const StressTable &before = whole.fracture->stress, &after = few.fracture->stress;
  EXPECT_EQ(after.positions, before.positions);
  ASSERT_EQ(after.largest.size(), order.size());
  ASSERT_EQ(after.stress.size(), 3 * kPoints * order.size());
  for (std::size_t m = 0; m < order.size(); ++m) {
    EXPECT_EQ(after.largest[m], before.largest[order[m]]);
    for (std::size_t row = 0; row < 3 * kPoints; ++row)
      EXPECT_EQ(after.stress[row * order.size() + m], before.stress[row * kModes + order[m]]);
  }
}

// Stress is stiffness times strain. A unit coordinate moves the body by 1 / (density size^3)^1/2, and strain is that
// over the size.
TEST(StrengthFile, AScaledBodyHasScaledStressSkinAndCrackEnergy) {
  const Bank bank = brittle_bank();
  const Bank other = scaled(bank, {.density = 1.5, .stiffness = 0.7, .size = 2});
  const Fracture &before = *bank.fracture, &after = *other.fracture;
  const double factor = 0.7 / std::sqrt(1.5 * 8) / 2;
  for (std::size_t i = 0; i < before.stress.stress.size(); ++i)
    EXPECT_NEAR(after.stress.stress[i], factor * before.stress.stress[i], 1e-6 * before.stress.largest[i % kModes]);
  for (std::size_t m = 0; m < kModes; ++m)
    EXPECT_NEAR(after.stress.largest[m], factor * before.stress.largest[m], 1e-6 * before.stress.largest[m]);
  EXPECT_EQ(after.stress.positions[2][1], 2 * before.stress.positions[2][1]);
  EXPECT_DOUBLE_EQ(after.skin_m2, 4 * before.skin_m2);
  EXPECT_EQ(after.strength->strength_pa, before.strength->strength_pa);
  EXPECT_DOUBLE_EQ(after.crack_energy_j_m2, before.crack_energy_j_m2 / 0.7);
}

struct Damage {
  const char* name;
  std::function<void(GlbParts&)> change;
  const char* expected;  // in the sentence
};

Json& fracture_in(GlbParts& parts) { return parts.model()["extras"]["ringdown"]["fracture"]; }

Json& accessor(GlbParts& parts, const char* field) {
  return parts.json["accessors"][fracture_in(parts)["stress"][field].get<std::size_t>()];
}

void set_float(GlbParts& parts, const char* field, std::size_t index, float value) {
  const Json& view = parts.json["bufferViews"][accessor(parts, field)["bufferView"].get<std::size_t>()];
  std::memcpy(parts.binary.data() + view["byteOffset"].get<std::size_t>() + index * sizeof(float), &value,
              sizeof value);
}

const std::vector<Damage>& damages() {
  static const std::vector<Damage> all = {
      {"StrengthZero", [](GlbParts& p) { fracture_in(p)["strength"]["stress"] = 0; }, "stress"},
      {"StrengthHuge", [](GlbParts& p) { fracture_in(p)["strength"]["stress"] = 1e300; }, "stress"},
      {"StrengthAbsent", [](GlbParts& p) { fracture_in(p)["strength"].erase("stress"); }, "stress"},
      {"StrengthAList", [](GlbParts& p) { fracture_in(p)["strength"] = {1, 2}; }, "strength"},
      {"ModulusBelowOne", [](GlbParts& p) { fracture_in(p)["strength"]["weibullModulus"] = 0.5; }, "weibullModulus"},
      {"ModulusAText", [](GlbParts& p) { fracture_in(p)["strength"]["weibullModulus"] = "7"; }, "weibullModulus"},
      {"AreaNegative", [](GlbParts& p) { fracture_in(p)["strength"]["area"] = -1; }, "area"},
      {"SkinAbsent", [](GlbParts& p) { fracture_in(p).erase("skinArea"); }, "skinArea"},
      {"SkinNegative", [](GlbParts& p) { fracture_in(p)["skinArea"] = -1; }, "skinArea"},
      {"CrackEnergyZero", [](GlbParts& p) { fracture_in(p)["crackEnergy"] = 0; }, "crackEnergy"},
      {"LargestTooShort", [](GlbParts& p) { accessor(p, "largest")["count"] = kModes - 1; }, "largest"},
      {"LargestNegative", [](GlbParts& p) { set_float(p, "largest", 2, -1); }, "largest"},
      {"LargestNotANumber", [](GlbParts& p) { set_float(p, "largest", 2, NAN); }, "not a finite number"},
      {"ComponentsTooShort", [](GlbParts& p) { accessor(p, "components")["count"] = 7; }, "components"},
      {"ComponentsNotANumber", [](GlbParts& p) { set_float(p, "components", 11, NAN); }, "not a finite number"},
      {"ComponentAboveTheLargest", [](GlbParts& p) { set_float(p, "components", 3, 2e4F); }, "components"},
      {"PositionsAbsent", [](GlbParts& p) { fracture_in(p)["stress"].erase("positions"); }, "positions"},
      {"PositionsNotThere", [](GlbParts& p) { fracture_in(p)["stress"]["positions"] = 9999; }, "9999"},
      {"StressANumber", [](GlbParts& p) { fracture_in(p)["stress"] = 3; }, "stress"},
  };
  return all;
}

TEST(StrengthFile, BrokenFilesAreRefusedByTheNameOfAField) {
  for (const Damage& damage : damages()) {
    GlbParts parts(written(brittle_bank()));
    damage.change(parts);
    const auto bank = parse(parts.join());
    ASSERT_FALSE(bank) << damage.name;
    EXPECT_NE(bank.error().message.find(damage.expected), std::string::npos)
        << damage.name << ": " << bank.error().message;
  }
}

}  // namespace
}  // namespace ringdown::modal::strength_file_test
