// What modes lose, and to what: from materials, in files, and in another material.
#include "engine/modal/losses.h"

#include "engine/modal/material_scale.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ringdown::modal::test {
namespace {

using ringdown::test::bar_bank;

const std::vector<LossFactor> kList = {{100, 0.02}, {1000, 0.002}, {10000, 0.02}};
const MaterialDamping kListed{fit_rayleigh(kList), kList};

double lambda_at(double frequency_hz) { return std::pow(2 * M_PI * frequency_hz, 2); }

TEST(Losses, ALossFactorLiesOnTheLineBetweenItsNeighboursInLogarithmsAndIsHeldBeyondTheEnds) {
  EXPECT_NEAR(loss_factor_at(kList, 200), 0.01, 1e-12);
  EXPECT_NEAR(loss_factor_at(kList, 5000), 0.01, 1e-12);
  EXPECT_NEAR(loss_factor_at(kList, 1000), 0.002, 1e-15);
  EXPECT_EQ(loss_factor_at(kList, 1), 0.02);
  EXPECT_EQ(loss_factor_at(kList, 50000), 0.02);
}

TEST(Losses, AModeOfAListDecaysByTheLossFactorAtItsOwnFrequency) {
  for (const double f : {50.0, 200.0, 1000.0, 5000.0}) {
    const ModeLoss loss = mode_loss(kListed, lambda_at(f), 0.7);
    EXPECT_NEAR(loss.material_per_s, M_PI * f * loss_factor_at(kList, f), 1e-9 * f);
    EXPECT_EQ(loss.air_per_s, 0.7);
    EXPECT_EQ(loss.support_per_s, 0);
  }
}

TEST(Losses, WhatTheAirTakesIsLeftOutOfWhatAirAndSupportTakeTogether) {
  const MaterialDamping damping{{5, 3e-8}, {}};
  const double lambda = lambda_at(1000);
  for (const double air : {0.0, 1.0, 2.5, 40.0}) {
    const ModeLoss loss = mode_loss(damping, lambda, air);
    EXPECT_NEAR(loss.material_per_s, 1.5e-8 * lambda, 1e-12);
    EXPECT_NEAR(loss.total_per_s(), 1.5e-8 * lambda + std::max(2.5, air), 1e-12);
    EXPECT_GE(loss.support_per_s, 0);
  }
}

TEST(Losses, TheHighestEigenvalueInABandIsThatOfAModeAtItsTop) {
  for (const double f : {150.0, 2000.0, 20000.0}) {
    const double lambda = highest_lambda(f, kListed);
    EXPECT_NEAR(with_decay(lambda, mode_loss(kListed, lambda).total_per_s()).frequency_hz, f, 1e-9 * f);
  }
  EXPECT_EQ(highest_lambda(2000, {{5, 3e-8}, {}}), highest_lambda_in_band(2000, {5, 3e-8}));
}

Bank listed_bank() {
  Bank bank = bar_bank(8);
  bank.material->loss_factors = kList;
  bank.material->damping = kListed.rayleigh;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    bank.losses.push_back(mode_loss(kListed, lambda, 0.1 * static_cast<double>(m)));
    const DampedMode mode = with_decay(lambda, bank.losses[m].total_per_s());
    bank.frequency_hz[m] = mode.frequency_hz;
    bank.decay_per_s[m] = mode.decay_per_s;
  }
  return bank;
}

// Four times as stiff, every mode is an octave higher, and loses what the list says there.
TEST(Losses, AModeInAnotherMaterialLosesWhatTheListSaysAtItsNewFrequency) {
  const Bank bank = listed_bank();
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double f = std::sqrt(undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]})) / (2 * M_PI);
    const ModeLoss loss = rescaled_loss(bank, m, {.stiffness = 4});
    EXPECT_NEAR(loss.material_per_s, M_PI * 2 * f * loss_factor_at(kList, 2 * f), 1e-9 * f);
    EXPECT_EQ(loss.support_per_s, 0);
  }
}

ModeHeat heat_of_mode(std::size_t m) {
  ModeHeat heat;
  for (std::size_t j = 0; j < heat.size(); ++j)
    heat[j] = {1e-3 / static_cast<double>(j * j + m + 1), 1e-3 / static_cast<double>(j + 1)};
  return heat;
}

// With all four parts.
Bank warm_bank() {
  Bank bank = listed_bank();
  bank.material->thermal = Thermal{1.2e-5, 50, 460};
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    bank.heat.push_back(heat_of_mode(m));
    bank.losses[m].heat_per_s = heat_loss(bank.heat[m], std::sqrt(lambda));
    bank.losses[m].support_per_s = 0.3;
    const DampedMode mode = with_decay(lambda, bank.losses[m].total_per_s());
    bank.frequency_hz[m] = mode.frequency_hz;
    bank.decay_per_s[m] = mode.decay_per_s;
  }
  return bank;
}

TEST(Losses, EachFactorScalesItsOwnPart) {
  const Bank bank = warm_bank();
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const ModeLoss once = bank.losses[m];
    const ModeLoss scaled = rescaled_loss(bank, m, {.alpha = 2, .beta = 3, .heat = 5, .air = 7});
    EXPECT_NEAR(scaled.support_per_s / once.support_per_s, 2, 1e-12);
    EXPECT_NEAR(scaled.material_per_s / once.material_per_s, 3, 1e-12);
    EXPECT_NEAR(scaled.heat_per_s / once.heat_per_s, 5, 1e-9);
    EXPECT_NEAR(scaled.air_per_s, 7 * once.air_per_s, 1e-12);
  }
}

// Heat needs four times as long through a wall that is twice as thick, and carries a share of Young's modulus over the
// heat capacity per volume.
TEST(Losses, HeatGoesAsFrequencyTimesThicknessSquared) {
  const Bank bank = warm_bank();
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double omega = std::sqrt(undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}));
    const MaterialScale scale{.density = 0.5, .stiffness = 3, .size = 2};
    const double scaled_omega = omega * std::sqrt(3 / 0.5) / 2;
    double eta = 0;
    for (const Relaxation& one : heat_of_mode(m)) {
      const double x = scaled_omega * one.time_s * 4 * 0.5;
      eta += one.strength * (3 / 0.5) * x / (1 + x * x);
    }
    EXPECT_NEAR(rescaled_loss(bank, m, scale).heat_per_s / (0.5 * eta * scaled_omega), 1, 1e-9);
  }
}

TEST(Losses, AModeOfALargerBodyRadiatesTheSameShareOfItsEnergyInACycle) {
  const Bank bank = listed_bank();
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    EXPECT_NEAR(rescaled_loss(bank, m, {.size = 2}).air_per_s, bank.losses[m].air_per_s / 2, 1e-12);
  }
}

TEST(LossesInAFile, RelaxationsThatContradictTheLossAreNotRead) {
  for (const double factor : {1.01, 1e-300, 1e12}) {
    Bank bank = warm_bank();
    bank.heat[2] = multiplied(bank.heat[2], factor, 1);
    const auto back = parse(written(bank));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(back->heat.empty());
    EXPECT_EQ(back->losses.size(), bank.mode_count());
    // The loss factor of heat then stays: four times as stiff, the mode is an octave higher.
    EXPECT_NEAR(rescaled_loss(*back, 2, {.stiffness = 4}).heat_per_s / bank.losses[2].heat_per_s, 2, 1e-9);
  }
}

TEST(LossesInAFile, TheirPartsComeBackAndAreTheSameFileAgain) {
  const Bank bank = warm_bank();
  const std::string once = written(bank);
  const auto back = parse(once);
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->losses.size(), bank.mode_count());
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    EXPECT_EQ(back->losses[m].material_per_s, bank.losses[m].material_per_s);
    EXPECT_EQ(back->losses[m].air_per_s, bank.losses[m].air_per_s);
    EXPECT_EQ(back->losses[m].support_per_s, bank.losses[m].support_per_s);
    EXPECT_EQ(back->losses[m].heat_per_s, bank.losses[m].heat_per_s);
  }
  EXPECT_EQ(back->heat, bank.heat);
  EXPECT_EQ(back->material->thermal, bank.material->thermal);
  ASSERT_EQ(back->material->loss_factors.size(), kList.size());
  EXPECT_EQ(back->material->loss_factors[1].eta, kList[1].eta);
  EXPECT_EQ(back->material->damping, fit_rayleigh_to_list(kList)) << "fitted again";
  EXPECT_EQ(written(*back), once);
}

TEST(LossesInAFile, AlphaAndBetaAreLeftOutWhereTheyMissTheMaterialByMoreThanOnePercent) {
  Bank bank = listed_bank();
  GlbParts parts(written(bank));
  EXPECT_FALSE(parts.extension()["acousticMaterials"][0].contains("alpha"));
  EXPECT_FALSE(parts.extension()["acousticMaterials"][0].contains("beta"));
  const RayleighDamping truth{12, 3e-7};
  bank.material->loss_factors.clear();
  for (double f = 20; f < 25000; f *= 1.13) bank.material->loss_factors.push_back({f, loss_factor(truth, f)});
  bank.material->damping = fit_rayleigh(bank.material->loss_factors);
  parts = GlbParts(written(bank));
  const auto& material = parts.extension()["acousticMaterials"][0];
  ASSERT_TRUE(material.contains("alpha") && material.contains("beta"));
  EXPECT_NEAR(material["alpha"].get<double>(), truth.alpha_per_s, 1e-6);
}

TEST(LossesInAFile, PartsThatDoNotAddUpCountAsUnknown) {
  const std::string good = written(listed_bank());
  const auto losses_of = [&](const auto& change) {
    GlbParts parts(good);
    change(parts.model()["extras"]["ringdown"]["losses"]);
    const auto bank = parse(parts.join());
    EXPECT_TRUE(bank) << bank.error().message;
    return bank ? bank->losses.size() : 99;
  };
  EXPECT_EQ(losses_of([](Json&) {}), 8u);
  EXPECT_EQ(losses_of([](Json& l) { l["air"][3] = l["air"][3].get<double>() + 1; }), 0u);
  EXPECT_EQ(losses_of([](Json& l) { l["air"][3] = -1; }), 0u);
  EXPECT_EQ(losses_of([](Json& l) { l["support"].erase(7); }), 0u);
  EXPECT_EQ(losses_of([](Json& l) { l.erase("material"); }), 0u);
  EXPECT_EQ(losses_of([](Json& l) { l = "all"; }), 0u);
}

TEST(LossesInAFile, AListThatIsNoCurveCountsAsNone) {
  const std::string good = written(listed_bank());
  const auto length_of = [&](const Json& list) {
    GlbParts parts(good);
    parts.model()["extras"]["ringdown"]["lossFactors"] = list;
    const auto bank = parse(parts.join());
    EXPECT_TRUE(bank) << bank.error().message;
    return bank ? bank->material->loss_factors.size() : 99;
  };
  EXPECT_EQ(length_of({{100, 0.1}, {200, 0.2}}), 2u);
  EXPECT_EQ(length_of({{200, 0.1}, {100, 0.2}}), 0u);
  EXPECT_EQ(length_of({{100, 0.1}, {100, 0.2}}), 0u);
  EXPECT_EQ(length_of({{0, 0.1}, {100, 0.2}}), 0u);
  EXPECT_EQ(length_of({{10, 0}, {100, 0.2}}), 0u);
  EXPECT_EQ(length_of({{10, 1e300}, {100, 0.2}}), 0u);
  EXPECT_EQ(length_of({1, 2, 3}), 0u);
  EXPECT_EQ(length_of("none"), 0u);
}

TEST(LossesInAFile, ANodesScaleScalesEveryPart) {
  GlbParts parts(written(listed_bank()));
  parts.json["nodes"][0]["scale"] = {2, 2, 2};
  const Bank one = parse(written(listed_bank())).value(), two = parse(parts.join()).value();
  for (std::size_t m = 0; m < one.mode_count(); ++m) {
    EXPECT_NEAR(two.losses[m].total_per_s(), two.decay_per_s[m], 1e-6 * two.decay_per_s[m]);
    EXPECT_NEAR(two.losses[m].air_per_s, one.losses[m].air_per_s / 2, 1e-12);
  }
}

}  // namespace
}  // namespace ringdown::modal::test
