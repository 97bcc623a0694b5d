// Liquids in object files and in bakes.
#include "engine/bake/bake_object.h"
#include "engine/bake/object_file.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/damping.h"
#include "engine/modal/levels/level_bank.h"
#include "tests/bake/cup.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::liquid_test {
namespace {

namespace fs = std::filesystem;
using Kind = liquid::Amount::Kind;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

Result<bake::ObjectRecipe> parsed(const std::string& tables) {
  return bake::parse_object("material = \"glass\"\ngeometry = \"glass.msh\"\n" + tables, "glass.toml");
}

std::string refusal(const std::string& tables) {
  const auto recipe = parsed(tables);
  return recipe ? "accepted" : recipe.error().message;
}

TEST(LiquidRecipe, AnObjectFileSaysHowFarItIsFilledAndHowDeepItStands) {
  EXPECT_TRUE(parsed("").value().options.liquids.none());
  const bake::Liquids liquids = parsed(
                                    "[fill]\nliquid = \"mercury\"\nvolume_ml = 50\nup = [0, 1, 0]\n"
                                    "basin = [0, 0, 1, 2, 3, 4]\n[bath]\nlevel_m = 0.03\n")
                                    .value()
                                    .options.liquids;
  ASSERT_TRUE(liquids.fill && liquids.bath);
  EXPECT_EQ(liquids.fill->liquid.name, "mercury");
  EXPECT_EQ(liquids.fill->amount.kind, Kind::kVolume);
  EXPECT_DOUBLE_EQ(liquids.fill->amount.value, 50e-6);
  EXPECT_EQ(liquids.fill->up, (Vec3{0, 1, 0}));
  EXPECT_EQ(liquids.fill->basins_m, (std::vector<Vec3>{{0, 0, 1}, {2, 3, 4}}));
  EXPECT_EQ(liquids.bath->liquid.name, "water");
  EXPECT_EQ(liquids.bath->level_m, 0.03);
  EXPECT_EQ(parsed("[fill]\ndepth_m = 0.02\n").value().options.liquids.fill->amount.kind, Kind::kDepth);
  EXPECT_EQ(parsed("[fill]\nfull = true\n").value().options.liquids.fill->amount.kind, Kind::kFull);
}

TEST(LiquidRecipe, AWrongValueIsRefusedWithASentence) {
  const std::string one = "say how far it is filled by one of level_m, depth_m, volume_ml or full = true";
  EXPECT_NE(refusal("[fill]\n").find(one), std::string::npos);
  EXPECT_NE(refusal("[fill]\nlevel_m = 0.1\nfull = true\n").find(one), std::string::npos);
  for (const char* tables : {"[fill]\ndepth_m = 0\n", "[fill]\ndepth_m = -1\n", "[fill]\nvolume_ml = 0\n",
                             "[fill]\nfull = true\nbasin = [1, 2]\n", "[fill]\nfull = true\nup = [0, 0, 0]\n",
                             "[fill]\nfull = true\nfoam = 1\n", "[bath]\n", "[bath]\nlevel_m = nan\n"})
    EXPECT_EQ(refusal(tables).find("glass.toml:"), 0u) << tables << refusal(tables);
}

TEST(LiquidRecipe, AirAsDenseAsALiquidIsRefusedWithAPointerToTheBath) {
  EXPECT_NE(refusal("radiation = true\nair = [998.2, 1482]\n").find("[bath]"), std::string::npos);
  EXPECT_EQ(refusal("radiation = true\nair = [6.2, 135]\n"), "accepted") << "sulphur hexafluoride";
}

TEST(LiquidRecipe, EachLiquidOfThePresetsIsReadAndAMissingOneIsNamed) {
  for (const char* name : {"water", "ethanol", "mercury", "glycerol"})
    EXPECT_TRUE(liquid::find_liquid(kPresets / "liquids", name)) << name;
  const auto missing = liquid::find_liquid(kPresets / "liquids", "beer");
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().message.find("choose one of: ethanol, glycerol, mercury, water"), std::string::npos);
}

class LiquidBake : public ::testing::Test {
 protected:
  Result<bake::BakedObject> baked(const std::string& tables, const std::string& geometry = test::kCup,
                                  int wall_nodes = liquid::kWetNodes) {
    (void)folder_.write("cup.geo", geometry);
    const fs::path file = folder_.write(
        "cup.toml",
        "material = \"glass\"\ngeometry = \"cup.geo\"\nunit_m = 0.001\nmesh_size_m = 0.012\nelement = \"tet10\"\n"
        "shape_error = 0.2\nband_hz = [20, 9000]\n" +
            tables);
    auto recipe = bake::read_object(file);
    if (!recipe) return fail(recipe.error());
    recipe->options.cache.clear();
    if (recipe->options.liquids.fill) recipe->options.liquids.fill->wall_nodes = wall_nodes;
    return bake::bake_object(*recipe, kPresets / "materials");
  }
  std::string why(const std::string& tables, const std::string& geometry = test::kCup) {
    const auto object = baked(tables, geometry);
    return object ? "accepted" : object.error().message;
  }
  test::TemporaryFolder folder_;
};

double lowest(const modal::Bank& bank) { return *std::ranges::min_element(bank.frequency_hz); }

TEST_F(LiquidBake, LevelsThatCannotBeAreRefusedWithOneSentence) {
  EXPECT_NE(
      why("[fill]\nlevel_m = 0.07\n").find("above the rim, and the liquid spills: the basin reaches from 0.004 m"),
      std::string::npos);
  EXPECT_NE(why("[fill]\nlevel_m = 0.001\n").find("below the bottom"), std::string::npos);
  EXPECT_NE(why("[fill]\nvolume_ml = 5000\n").find("it spills"), std::string::npos);
  EXPECT_NE(why("[fill]\nlevel_m = 0.055\nup = [0.5, 0, 1]\n").find("spills"), std::string::npos) << "tilted";
  EXPECT_NE(why("[fill]\nfull = true\nup = [0, 0, -1]\n").find("no basin"), std::string::npos) << "upside down";
  EXPECT_NE(why("[fill]\nfull = true\nbasin = [1, 0, 0]\n").find("there is no basin at (1, 0, 0)"), std::string::npos);
  EXPECT_NE(why("[bath]\nlevel_m = -0.1\n").find("below the body's lowest point"), std::string::npos);
  EXPECT_NE(why("[bath]\nlevel_m = 0.1\n").find("covers all of it"), std::string::npos);
  EXPECT_NE(why("nonlinear = 3\n[fill]\nfull = true\n").find("nonlinear"), std::string::npos);
  EXPECT_NE(why("[shatter]\n[fill]\nfull = true\n").find("a body with a liquid cannot be broken"), std::string::npos);
  const std::string tube = R"(SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 60, 30}; Cylinder(2) = {0, 0, -1, 0, 0, 62, 26};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
)";
  EXPECT_NE(why("[fill]\nfull = true\n", tube).find("it would leak"), std::string::npos);
}

// The dry cup, the cup in a bath and the full cup: frequencies fall, losses have the right owners, and the bank says
// so.
TEST_F(LiquidBake, LiquidLowersTheModesAndTheBankSaysSo) {
  const auto dry = baked(""), full = baked("[fill]\nfull = true\n"), bath = baked("[bath]\nlevel_m = 0.03\n");
  ASSERT_TRUE(dry && full && bath) << (full ? "" : full.error().message) << (bath ? "" : bath.error().message);
  const modal::Bank &empty = dry->baked.bank, &filled = full->baked.bank, &standing = bath->baked.bank;
  EXPECT_LT(lowest(filled), 0.9 * lowest(empty));
  EXPECT_LT(lowest(standing), 0.99 * lowest(empty));
  EXPECT_GT(lowest(standing), lowest(filled));
  ASSERT_EQ(filled.provenance.liquids.size(), 1u);
  const modal::LiquidNote& note = filled.provenance.liquids.front();
  EXPECT_EQ(note.liquid, "water");
  EXPECT_FALSE(note.around);
  EXPECT_NEAR(note.level_m, 0.06, 1e-6);
  EXPECT_NEAR(1e6 * note.volume_m3, 1e-3 * std::numbers::pi * 26 * 26 * 56, 0.01 * 119);
  EXPECT_TRUE(standing.provenance.liquids.front().around);
  EXPECT_EQ(filled.provenance.counted_modes, 0) << "only the dry body's modes were counted";
  for (std::size_t m = 0; m < filled.mode_count(); ++m) {
    const modal::ModeLoss& loss = filled.losses[m];
    const double whole = 0.0006 * modal::hz_to_rad_per_s(filled.frequency_hz[m]) / 2;  // if all strain is in the glass
    EXPECT_GT(loss.material_per_s, 0);
    EXPECT_LT(loss.material_per_s, 1.001 * whole);
    EXPECT_GT(loss.support_per_s, 0) << "the boundary layer of the water";
  }
  const fs::path path = folder_.path() / "full.glb";
  ASSERT_TRUE(modal::write_bank(filled, path));
  const auto read = modal::read_bank(path);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->provenance.liquids.size(), 1u);
  EXPECT_EQ(read->provenance.liquids.front().volume_m3, note.volume_m3);
}

// The bank with levels and the bake that it is compared with have the same coarse wall of the liquid, because that is
// quick and moves the pitches of both alike.
TEST_F(LiquidBake, BelowFiveKilohertzALevelIsWithinACentOfABakeAndNoModeJumpsOnTheWayThere) {
  constexpr int kNodes = 500;
  const auto full = baked("[fill]\nfull = true\nlevels = 8\n", test::kCup, kNodes);
  ASSERT_TRUE(full) << full.error().message;
  for (const double level_m : {0.037, 0.0565}) {
    const auto bake = baked(formatted("[fill]\nlevel_m = {}\n", level_m), test::kCup, kNodes);
    const auto there = modal::at_level(full->baked.bank, level_m);
    ASSERT_TRUE(bake && there);
    EXPECT_LT(lowest(bake->baked.bank), 5000);
    for (const double hz : bake->baked.bank.frequency_hz) {
      if (hz > 5000) continue;
      double nearest = 1e9;
      for (const double own : there->bank.frequency_hz)
        nearest = std::min(nearest, std::abs(1200 * std::log2(own / hz)));
      EXPECT_LT(nearest, 1) << "cents, of " << hz << " Hz at " << level_m << " m";
    }
  }
  // The liquid's own modes rise above the band.
  constexpr double kStep_m = 0.0005;
  std::vector<double> before;
  for (double level_m = 0.0045; level_m < 0.06; level_m += kStep_m) {
    const std::vector<double> now = modal::at_level(full->baked.bank, level_m)->bank.frequency_hz;
    for (std::size_t m = 0; m < before.size(); ++m) {
      EXPECT_LT(now[m], 1.005 * before[m]) << "Hz of mode " << m << " at " << level_m << " m: water is mass";
      EXPECT_GT(now[m], 0.97 * before[m]) << "Hz of mode " << m << " at " << level_m << " m";
    }
    before = now;
  }
}

}  // namespace
}  // namespace ringdown::liquid_test
