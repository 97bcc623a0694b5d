// Banks of other levels of a liquid, against closed forms.
#include "engine/modal/levels/level_bank.h"

#include "engine/modal/bank_file.h"
#include "engine/modal/levels/symmetric_spectrum.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace ringdown::modal {
namespace {

using test::kDrag;
using test::kMassPerSquare;
using test::leveled_bank;

double omega_of(const Bank& bank, std::size_t mode) {
  return std::sqrt(undamped_lambda({bank.frequency_hz[mode], bank.decay_per_s[mode]}));
}

TEST(SymmetricSpectrum, ProblemsAreSolvedToRounding) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  for (const std::size_t n : {1, 2, 3, 17}) {
    std::vector<double> root(n * n), stiffness(n * n), mass(n * n);
    for (double& x : root) x = any(random);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        stiffness[i * n + j] = root[i * n + j] + root[j * n + i];
        mass[i * n + j] = i == j ? 1 : 0;
        for (std::size_t k = 0; k < n; ++k) mass[i * n + j] += root[i * n + k] * root[j * n + k];
      }
    }
    const auto found = generalized_spectrum(stiffness, mass, n);
    ASSERT_TRUE(found);
    const std::vector<double> steep = product(stiffness, found->vectors, n), heavy = product(mass, found->vectors, n);
    const std::vector<double> unit = transposed_product(found->vectors, heavy, n);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_TRUE(i == 0 || found->values[i] >= found->values[i - 1]);
      for (std::size_t j = 0; j < n; ++j) {
        EXPECT_NEAR(steep[i * n + j], found->values[j] * heavy[i * n + j], 1e-11);
        EXPECT_NEAR(unit[i * n + j], i == j ? 1 : 0, 1e-11);
      }
    }
  }
  EXPECT_FALSE(generalized_spectrum({1}, {-1}, 1));
}

// A spline follows a cubic polynomial exactly, so the mass x^2 comes to rounding at every height.
TEST(LevelBank, APitchFallsAsTheRootOfTheMassThatTheLiquidAdds) {
  const Bank bank = leveled_bank(440, 2);
  const double dry = omega_of(bank, 0);
  for (const double x : {0.0, 0.004, 0.03, 0.0471, 0.0999, 0.1}) {
    const auto there = at_level(bank, x);
    ASSERT_TRUE(there) << there.error().message;
    const double mass = 1 + kMassPerSquare * x * x, omega = omega_of(there->bank, 0);
    EXPECT_NEAR(omega / dry * std::sqrt(mass), 1, 1e-6) << x;
    EXPECT_NEAR(there->bank.shape(0, 2)[2] * std::sqrt(mass), bank.shape(0, 2)[2], 1e-5);
    EXPECT_NEAR(there->bank.provenance.liquids[0].level_m, x, 1e-12);
    EXPECT_NEAR(there->bank.provenance.liquids[0].volume_m3, 0.01 * x, 1e-9);
    const ModeLoss loss = there->bank.losses[0];
    EXPECT_NEAR(loss.support_per_s, 2 / mass + kDrag * x * std::sqrt(omega), 1e-4);
    EXPECT_NEAR(there->bank.decay_per_s[0], loss.total_per_s(), 1e-12);
  }
}

// One mode of the body (mass 1, k = omega_1^2) and one of the liquid: (k - l m)(c - l g) = l^2 e^2.
TEST(LevelBank, ALiquidThatGivesWayIsOneMoreOscillator) {
  Bank bank = leveled_bank(440, 0);
  LiquidLevels levels = *bank.levels;
  const double k = static_cast<double>(levels.stiffness[0]), c = 4 * k, s = 0.6;
  levels.liquid = 1;
  levels.following = {1};
  // y = Omega^-2 s c turns the oscillator of unit mass into one of these.
  for (std::size_t l = 0; l < levels.levels(); ++l) {
    levels.added[l] = 1;
    levels.bond.push_back(static_cast<float>(s * s / c));
    levels.liquid_mass.push_back(static_cast<float>(s * s / (c * c)));
  }
  bank.levels = std::make_shared<const LiquidLevels>(levels);
  const auto there = at_level(bank, 0.05);
  ASSERT_TRUE(there) << there.error().message;
  // l^2 (2 - s^2) - l (k + 2 c) + k c = 0
  const double a = 2 - s * s, b = k + 2 * c;
  const double lower = (b - std::sqrt(b * b - 4 * a * k * c)) / (2 * a);
  EXPECT_NEAR(omega_of(there->bank, 0) / std::sqrt(lower), 1, 1e-6);
}

// With more coupling than the masses allow, which a spline may leave, the body rings with the mass that the liquid
// adds.
TEST(LevelBank, AMotionOfTheLiquidThatCannotBeIsLeftOut) {
  Bank bank = leveled_bank(440, 0);
  LiquidLevels levels = *bank.levels;
  levels.liquid = 1;
  levels.following = {1};
  for (std::size_t l = 0; l < levels.levels(); ++l) {
    levels.added[l] = 1;
    levels.bond.push_back(1.5F * std::sqrt(2e-6F));
    levels.liquid_mass.push_back(1e-6F);
  }
  bank.levels = std::make_shared<const LiquidLevels>(levels);
  const auto there = at_level(bank, 0.05);
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_NEAR(omega_of(there->bank, 0) / omega_of(bank, 0), std::sqrt(0.5), 1e-6);
}

// Three motions of a body, and a liquid of height x (1: full) whose one mode has the eigenvalue c / x and pulls them
// with s x. The lowest mode is the first root of  l c/x / (c/x - l) sum of (s_i x)^2 / (k_i - l) = 1.
struct ThreeMotions {
  std::array<double, 3> stiffness{};
  std::array<double, 3> pull{};
  double own = 0;

  [[nodiscard]] double lowest(double x) const {
    const double top = own / x;
    double low = 0, high = (1 - 1e-12) * std::min(stiffness[0], top);
    for (int turn = 0; turn < 100; ++turn) {
      const double l = (low + high) / 2;
      double sum = 0;
      for (std::size_t i = 0; i < 3; ++i) sum += std::pow(pull[i] * x, 2) / (stiffness[i] - l);
      (l * top / (top - l) * sum < 1 ? low : high) = l;
    }
    return low;
  }
};

// The liquid's own mode at the brim is that of the body when it is empty, 1.6 octaves higher. On the way its motion is
// shared by three modes, of which others are more like it.
TEST(LevelBank, AModeOfTheLiquidRisesWithoutAJumpToTheModeOfTheBodyThatRepelsIt) {
  const auto squared = [](double hz) { return std::pow(hz_to_rad_per_s(hz), 2); };
  const ThreeMotions of{{squared(10e3), squared(20e3), squared(24e3)}, {0.35, 1.6, 2.0}, squared(4500)};
  const double full = of.lowest(1);
  Bank bank = leveled_bank(rad_per_s_to_hz(std::sqrt(full)), 0);
  LiquidLevels levels{.further = 2, .liquid = 1};
  // Columns: the motion of the lowest mode at the brim, whose mass with the liquid is 1, then the second and third
  // motion.
  std::array<double, 3> first{};
  double square = 0, along = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    first[i] = of.pull[i] / (of.stiffness[i] - full);
    square += first[i] * first[i];
    along += of.pull[i] * first[i];
  }
  const double length = std::sqrt(square + std::pow(along * of.own / (of.own - full), 2));
  const auto column = [&](std::size_t c, std::size_t i) { return c == 0 ? first[i] / length : c == i ? 1.0 : 0.0; };
  const auto sum = [&](std::size_t a, std::size_t b, const std::array<double, 3>& weight) {
    double total = 0;
    for (std::size_t i = 0; i < 3; ++i) total += column(a, i) * weight[i] * column(b, i);
    return static_cast<float>(total);
  };
  std::array<double, 3> pull{};
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < 3; ++i) pull[c] += of.pull[i] * column(c, i);
    for (std::size_t d = 0; d <= c; ++d) {
      levels.stiffness.push_back(sum(c, d, of.stiffness));
      levels.mass.push_back(sum(c, d, {1, 1, 1}));
    }
  }
  levels.following = {1, 0, 0};
  constexpr int kLevels = 12;
  for (int l = 0; l < kLevels; ++l) {
    const double x = l / (kLevels - 1.0), follows = pull[0] * x * x / of.own;  // y = s x / (c / x)
    levels.level_m.push_back(0.1 * x);
    levels.volume_m3.push_back(0.001 * x);
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t d = 0; d <= c; ++d) levels.added.push_back(static_cast<float>(pull[c] * pull[d] * x * x));
      levels.bond.push_back(static_cast<float>(pull[c] * x * follows));
    }
    levels.liquid_mass.push_back(static_cast<float>(follows * follows));
    levels.drag.push_back(0);
  }
  bank.provenance.liquids.front().level_m = 0.1;
  bank.levels = std::make_shared<const LiquidLevels>(levels);
  for (int step = 1; step <= 100; ++step) {
    const auto there = at_level(bank, 0.001 * step);
    ASSERT_TRUE(there) << there.error().message;
    EXPECT_NEAR(omega_of(there->bank, 0) / std::sqrt(of.lowest(0.01 * step)), 1, 0.003) << step << " %";
  }
}

// Momentum is kept where liquid joins, and velocity where it leaves.
TEST(LevelBank, WhatRingsLosesEnergyWithEachChangeOfLevel) {
  const Bank bank = leveled_bank(440, 2);
  const LevelModes low = at_level(bank, 0.02)->modes, high = at_level(bank, 0.08)->modes;
  const double m = 1 + kMassPerSquare * 4e-4, n = 1 + kMassPerSquare * 64e-4;
  const ModeTransfer rise = transfer(low, high), fall = transfer(high, low);
  EXPECT_NEAR(rise.velocity[0], std::sqrt(m / n), 1e-6);
  EXPECT_NEAR(fall.velocity[0], std::sqrt(m / n), 1e-6);
  EXPECT_NEAR(rise.displacement[0], 1, 1e-6) << "the strain stays";
  const ModeTransfer none = transfer(low, low);
  EXPECT_NEAR(none.velocity[0], 1, 1e-12);
  EXPECT_NEAR(transfer(as_baked(bank), at_level(bank, 0)->modes).velocity[0], 1, 1e-6);
}

// The energy of an oscillator over its frequency stays when its mass grows slowly, whatever grows.
TEST(LevelBank, ASlowRiseKeepsEnergyOverFrequency) {
  const Bank bank = leveled_bank(440, 0);
  constexpr int kSteps = 1000;
  LevelModes present = at_level(bank, 0)->modes;
  const double first = present.omega_rad_s[0];
  double displacement = 1, velocity = 0;  // each the root of twice its energy
  for (int step = 1; step <= kSteps; ++step) {
    LevelModes next = at_level(bank, 0.1 * step / kSteps)->modes;
    const ModeTransfer change = transfer(present, next);
    const double before = std::hypot(displacement, velocity);
    const double u = change.displacement[0] * displacement, v = change.velocity[0] * velocity;
    EXPECT_LE(std::hypot(u, v), before * (1 + 1e-9));
    constexpr double kTurn = 2.399963;  // some time passes
    displacement = u * std::cos(kTurn) + v * std::sin(kTurn);
    velocity = v * std::cos(kTurn) - u * std::sin(kTurn);
    present = std::move(next);
  }
  const double energy = displacement * displacement + velocity * velocity;
  EXPECT_NEAR(energy / (present.omega_rad_s[0] / first), 1, 0.005);
}

TEST(LevelBank, AFileKeepsTheLevels) {
  const test::TemporaryFolder folder;
  const Bank bank = leveled_bank(440, 2);
  for (const Compression how : {Compression::none, Compression::meshopt}) {
    ASSERT_TRUE(write_bank(bank, folder / "a.glb", {}, how));
    const auto read = read_bank(folder / "a.glb");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_TRUE(read->levels);
    EXPECT_EQ(read->levels->level_m, bank.levels->level_m);
    EXPECT_NEAR(omega_of(at_level(*read, 0.07)->bank, 0) / omega_of(at_level(bank, 0.07)->bank, 0), 1, 1e-5);
  }
}

TEST(LevelBank, ALevelOutOfTheBasinIsRefusedWithASentence) {
  const Bank bank = leveled_bank(440, 2);
  EXPECT_NE(at_level(bank, -0.01).error().message.find("below the bottom"), std::string::npos);
  EXPECT_NE(at_level(bank, 0.11).error().message.find("above the rim"), std::string::npos);
  EXPECT_NE(at_level(bank, std::nan("")).error().message.find("below the bottom"), std::string::npos);
  EXPECT_NE(at_level(test::single_mode_bank(440, 2), 0).error().message.find("levels = 16"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::modal
