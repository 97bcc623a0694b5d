// What a bank's modes radiate: in its file, and in another size and material.
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_choice.h"
#include "tests/modal/glb_editor.h"
#include "tests/support/synthetic_bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ringdown::modal::test {
namespace {

using namespace ringdown::test;  // NOLINT: the synthetic banks

FarField random_field(std::mt19937& random, double frequency_hz) {
  std::normal_distribution<float> value(0, 1e-3F);
  FarField field{.wavenumber_rad_m = 2 * M_PI * frequency_hz / 343.2};
  for (std::uint16_t harmonic = 0; harmonic < 16; ++harmonic) {
    field.terms.push_back({harmonic, {value(random), value(random)}});
  }
  // F rises as k below the mode's own wavenumber and falls as its inverse above it.
  for (const float octaves : {-1.0F, 0.0F, 1.0F}) {
    field.levels.push_back({.wavenumber_rad_m = static_cast<float>(field.wavenumber_rad_m) * std::exp2(octaves),
                            .rms = static_cast<float>(rms(field)) * std::exp2(-std::abs(octaves))});
  }
  return field;
}

Bank radiating_bank() {
  Bank bank = random_bank(7, 12, 40);
  bank.material = bar_bank(1).material;
  std::mt19937 random(3);
  bank.radiation =
      BankRadiation{.maps = {.origin_m = {0.1, 0, -0.2}}, .air = {.density_kg_m3 = 1.1, .sound_speed_m_s = 350}};
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    bank.radiation->maps.modes.push_back(random_field(random, bank.frequency_hz[m]));
    bank.radiation->error_db.push_back(0.01 * static_cast<double>(m));
    const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
    const double air =
        radiation_decay_per_s(rms(bank.radiation->maps.modes[m]), std::sqrt(lambda), bank.radiation->air);
    bank.losses.push_back(mode_loss(bank.material->damping_law(), lambda, air));
    const DampedMode mode = with_decay(lambda, bank.losses[m].total_per_s());
    bank.frequency_hz[m] = mode.frequency_hz;
    bank.decay_per_s[m] = mode.decay_per_s;
  }
  bank.radiation->reason.resize(bank.mode_count());
  bank.radiation->reason[5] = "its panels are too long";
  return bank;
}

TEST(BankRadiation, MapsComeBackWithinTheErrorOfTheirPackingAndTheSecondTripIsExact) {
  const Bank bank = radiating_bank();
  for (const Compression compression : {Compression::none, Compression::meshopt}) {
    const std::string once = written(bank, compression);
    const auto back = parse(once);
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_TRUE(back->radiation);
    const BankRadiation &before = *bank.radiation, &after = *back->radiation;
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      EXPECT_NEAR(rms(after.maps.modes[m]) / rms(before.maps.modes[m]), 1, kPackingError);
      EXPECT_NEAR(after.maps.modes[m].wavenumber_rad_m / before.maps.modes[m].wavenumber_rad_m, 1, 1e-6);
      EXPECT_EQ(after.maps.modes[m].levels.size(), 3u);
    }
    EXPECT_NEAR(length(after.maps.origin_m - before.maps.origin_m), 0, 1e-7);
    EXPECT_EQ(after.air.density_kg_m3, 1.1);
    EXPECT_EQ(after.air.sound_speed_m_s, 350);
    EXPECT_EQ(after.error_db, before.error_db);
    EXPECT_EQ(after.reason, before.reason);
    EXPECT_TRUE(written(*back, compression) == once);
  }
}

TEST(BankRadiation, ABankWithoutRadiationHasNoneInItsFile) {
  Bank bank = random_bank(1, 3, 12);
  bank.radiation.reset();
  GlbParts parts(written(bank));
  EXPECT_FALSE(parts.model()["extras"]["ringdown"].contains("radiation"));
  EXPECT_FALSE(parse(parts.join())->radiation);
}

TEST(BankRadiation, MapsThatDoNotBelongToTheModesAreRefusedByTheirField) {
  const std::string good = written(radiating_bank());
  const auto refusal = [&](const auto& change) {
    GlbParts parts(good);
    const std::size_t accessor = parts.model()["extras"]["ringdown"]["radiation"]["maps"];
    Json& array = parts.json["accessors"][accessor];
    change(parts, array, parts.json["bufferViews"][array["bufferView"].get<std::size_t>()]["byteOffset"].get<int>());
    const auto bank = parse(parts.join());
    EXPECT_FALSE(bank);
    return bank ? "" : bank.error().message;
  };
  const auto has = [](const std::string& message, const char* part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_NE(message.find("radiation"), std::string::npos) << message;
  };
  has(refusal([](GlbParts& p, Json&, int) { p.model()["extras"]["ringdown"]["radiation"]["maps"] = 99; }), "maps");
  const std::string positions =
      refusal([](GlbParts& p, Json&, int) { p.model()["extras"]["ringdown"]["radiation"]["maps"] = 0; });
  EXPECT_NE(positions.find("expected \"SCALAR\""), std::string::npos) << positions;
  has(refusal([](GlbParts&, Json& a, int) { a["count"] = a["count"].get<int>() - 1; }), "damaged");
  has(refusal([](GlbParts&, Json& a, int) { a["count"] = 10; }), "cut off");
  has(refusal([](GlbParts& p, Json&, int at) { p.binary[static_cast<std::size_t>(at)] = 2; }), "version 2");
  has(refusal([](GlbParts& p, Json&, int at) { p.binary[static_cast<std::size_t>(at) + 4] = 11; }), "last mode");
  const std::size_t eleven = pack({.modes = std::vector(11, radiating_bank().radiation->maps.modes[0])}).bytes.size();
  const auto few = pack({.modes = std::vector(11, radiating_bank().radiation->maps.modes[0])}).bytes;
  has(refusal([&](GlbParts& p, Json& a, int at) {
        a["count"] = eleven;
        std::memcpy(p.binary.data() + at, few.data(), eleven);
      }),
      "11 modes, expected 12");
}

TEST(BankRadiation, ANodesScaleScalesFarFieldsExactly) {
  GlbParts parts(written(radiating_bank()));
  const Bank one = parse(parts.join()).value();
  parts.json["nodes"][0]["scale"] = {4, 4, 4};
  const Bank four = parse(parts.join()).value();
  for (std::size_t m = 0; m < one.mode_count(); ++m) {
    const FarField &small = one.radiation->maps.modes[m], &large = four.radiation->maps.modes[m];
    EXPECT_NEAR(rms(large), 2 * rms(small), 1e-6 * rms(large));
    EXPECT_NEAR(large.wavenumber_rad_m, small.wavenumber_rad_m / 4, 1e-9);
    EXPECT_NEAR(large.levels[2].wavenumber_rad_m, small.levels[2].wavenumber_rad_m / 4, 1e-4);
    EXPECT_NEAR(large.levels[2].rms, 2 * small.levels[2].rms, 1e-6);
  }
  EXPECT_NEAR(four.radiation->maps.origin_m.x, 0.4, 1e-6);
  EXPECT_TRUE(written(parse(written(four)).value()) == written(four));
}

// The part that the air takes follows from the far field of the scaled body as it does when a bank is baked.
TEST(BankRadiation, TheAirsPartOfTheLossIsWhatTheScaledFarFieldRadiates) {
  const Bank bank = radiating_bank();
  for (const MaterialScale scale : {MaterialScale{.size = 1.7}, MaterialScale{.density = 2, .stiffness = 2},
                                    MaterialScale{.density = 0.6, .stiffness = 1.3, .size = 0.8}}) {
    for (std::size_t m = 0; m < bank.mode_count(); ++m) {
      const double lambda = undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]}) * lambda_factor(scale);
      const double level = rms(rescale(bank.radiation->maps.modes[m], scale));
      const double expected = radiation_decay_per_s(level, std::sqrt(lambda), bank.radiation->air);
      EXPECT_NEAR(rescaled_loss(bank, m, scale).air_per_s / expected, 1, 1e-4);
    }
  }
}

TEST(BankRadiation, AnOctaveHigherTheLevelIsTheOneThatTheMapGivesThere) {
  const Bank bank = radiating_bank();
  const FarField& field = bank.radiation->maps.modes[0];
  EXPECT_NEAR(rms(rescale(field, {.stiffness = 4})), 0.5 * rms(field), 1e-4 * rms(field));
  EXPECT_NEAR(rms(rescale(field, {.stiffness = 2})), rms(field) / std::sqrt(2), 1e-4 * rms(field));
}

TEST(ModeChoice, ModesAreTakenWithAllThatBelongsToThem) {
  const Bank bank = radiating_bank();
  Bank taken = bank;
  take_modes(taken, {5, 0});
  ASSERT_EQ(taken.mode_count(), 2u);
  EXPECT_EQ(taken.frequency_hz[0], bank.frequency_hz[5]);
  EXPECT_EQ(taken.losses[1].air_per_s, bank.losses[0].air_per_s);
  EXPECT_EQ(taken.radiation->reason[0], bank.radiation->reason[5]);
  EXPECT_EQ(taken.radiation->maps.modes[0].wavenumber_rad_m, bank.radiation->maps.modes[5].wavenumber_rad_m);
  EXPECT_EQ(taken.shape(0, 3), bank.shape(5, 3));
  EXPECT_EQ(taken.shapes.size(), 2 * bank.point_count());
}

}  // namespace
}  // namespace ringdown::modal::test
