// The material picker against an offline change of the same bank (engine/bake), and against plate and shaft formulas.
#include "clients/viewer/material_choice.h"

#include "engine/materials/material_change.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

const std::filesystem::path kPresets = RINGDOWN_SOURCE_DIR "/presets";

modal::Material material(const std::string& name) {
  const auto entry = bake::find_material(kPresets / "materials", name);
  EXPECT_TRUE(entry) << entry.error().message;
  return entry ? entry->material : modal::Material{};
}

// Materials with one loss factor at all frequencies: what the material takes is exact. Heat flows as strongly as in the
// wanted material, but at the pitch of the bank's own.
TEST(MaterialChoice, AChoiceSoundsAsTheBankThatRingdownScaleWrites) {
  const auto bank = modal::read_bank(kPresets / "banks" / "steel-plate.glb");
  ASSERT_TRUE(bank && bank->material);
  for (const char* name : {"glass", "aluminium", "copper", "cast-iron"}) {
    const MaterialChoice choice = choice_of(*bank->material, material(name));
    ASSERT_EQ(choice.obstacle, "") << name;
    const auto changed = bake::change(*bank, {.material = material(name)});
    ASSERT_TRUE(changed);
    std::vector<double> live, offline = changed->bank.frequency_hz, live_losses, losses;
    for (const modal::ModeLoss& loss : changed->bank.losses) losses.push_back(loss.total_per_s() - loss.heat_per_s);
    for (std::size_t m = 0; m < bank->mode_count(); ++m) {
      live.push_back(modal::rescale(*bank, m, choice.scale).frequency_hz);
      const modal::ModeLoss loss = modal::rescaled_loss(*bank, m, choice.scale);
      live_losses.push_back(loss.total_per_s() - loss.heat_per_s);
    }
    for (auto* values : {&live, &offline, &live_losses, &losses}) std::ranges::sort(*values);
    ASSERT_EQ(live.size(), offline.size()) << name;
    for (std::size_t m = 0; m < live.size(); ++m) {
      EXPECT_NEAR(live[m] / offline[m], 1, 1e-5) << name;
      EXPECT_NEAR(live_losses[m] / losses[m], 1, 1e-4) << name;
    }
  }
}

TEST(MaterialChoice, TheErrorOfPoissonsRatioIsThatOfPlatesAndShafts) {
  modal::Material bank{.name = "bank", .youngs_modulus_pa = 2e11, .poisson_ratio = 0.3, .density_kg_m3 = 7800};
  modal::Material wanted = bank;
  wanted.poisson_ratio = 0.45;
  const MaterialChoice choice = choice_of(bank, wanted);
  const auto plate = [](const modal::Material& m) {  // sqrt of the bending stiffness
    return std::sqrt(m.youngs_modulus_pa / (1 - m.poisson_ratio * m.poisson_ratio));
  };
  const auto shaft = [](const modal::Material& m) {  // sqrt of the shear modulus
    return std::sqrt(m.youngs_modulus_pa / (2 * (1 + m.poisson_ratio)));
  };
  EXPECT_NEAR(choice.plate_error, plate(wanted) / plate(bank) - 1, 1e-12);
  EXPECT_NEAR(choice.twist_error, shaft(wanted) / shaft(bank) - 1, 1e-12);
  EXPECT_NE(describe(bank, wanted).find("0.30"), std::string::npos) << describe(bank, wanted);
  EXPECT_NE(describe(bank, wanted).find("plates would\nsound 6.8 % higher"), std::string::npos)
      << describe(bank, wanted);
  EXPECT_NE(describe(bank, wanted).find("twisting modes 5.3 % lower"), std::string::npos) << describe(bank, wanted);
  wanted.poisson_ratio = bank.poisson_ratio;
  EXPECT_NE(describe(bank, wanted).find("exact"), std::string::npos);
}

TEST(MaterialChoice, WhatABankCannotFollowIsSaid) {
  const modal::Material bank{
      .name = "bank", .youngs_modulus_pa = 2e11, .poisson_ratio = 0.3, .density_kg_m3 = 7800, .damping = {0, 1e-8}};
  modal::Material soft = bank;
  soft.youngs_modulus_pa = 1e7;
  EXPECT_NE(choice_of(bank, soft).obstacle, "");
  modal::Material damped = bank;
  damped.damping.alpha_per_s = 5;
  EXPECT_EQ(choice_of(bank, damped).obstacle, "");
  EXPECT_EQ(choice_of(bank, damped).scale.alpha, 1);
  EXPECT_NE(choice_of(bank, damped).reservation.find("alpha"), std::string::npos);
  EXPECT_NE(choice_of({.name = "recorded"}, bank).obstacle, "");
}

TEST(MaterialChoice, TheMaterialIsKnownByItsFactorsWhateverTheSize) {
  const std::vector<modal::Material> known = known_materials();
  EXPECT_GT(known.size(), 30u);
  const modal::Material steel = material("steel");
  for (const char* name : {"glass", "spruce"}) {
    modal::MaterialScale scale = choice_of(steel, material(name)).scale;
    scale.size = 2;
    EXPECT_EQ(material_name(steel, scale, known), name);
    scale.stiffness *= 1.1;
    EXPECT_EQ(material_name(steel, scale, known), "");
  }
  EXPECT_EQ(material_name(steel, {}, known), "steel");
}

}  // namespace
}  // namespace ringdown::viewer
