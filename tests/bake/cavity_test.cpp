// The air in bodies, in object files, banks and sessions.
#include "engine/bake/cavity/cavity.h"
#include "engine/bake/object_file.h"
#include "engine/modal/bank_file.h"
#include "engine/modal/mode_choice.h"
#include "engine/modal/scaled_bank.h"
#include "tests/support/synthetic_bank.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace ringdown::cavity_test {
namespace {

const std::string kCavity = "[cavity]\nmouth_m = [0, 0, 0.3]\ndiameter_m = 0.0195\n";

Result<bake::ObjectRecipe> parsed(const std::string& tables) {
  return bake::parse_object("material = \"glass\"\ngeometry = \"bottle.msh\"\n" + tables, "bottle.toml");
}

std::string refusal(const std::string& tables) {
  const auto recipe = parsed(tables);
  return recipe ? "accepted" : recipe.error().message;
}

TEST(CavityRecipe, AnObjectFileSaysWhereTheMouthIs) {
  const auto options = parsed(kCavity + "modes = 2\n").value().options;
  ASSERT_TRUE(options.cavity);
  EXPECT_EQ(options.cavity->mouth_m.z, 0.3);
  EXPECT_EQ(options.cavity->modes, 2);
  EXPECT_TRUE(options.air);  // its note radiates
  EXPECT_EQ(options.cavity->scaled(2).diameter_m, 0.039);
  EXPECT_EQ(parsed(kCavity).value().options.cavity->modes, 1);
  EXPECT_FALSE(parsed("").value().options.cavity);
  EXPECT_NE(refusal("[cavity]\nmouth_m = [0, 0, 0.3]\n").find("diameter_m"), std::string::npos);
  EXPECT_NE(refusal("[cavity]\ndiameter_m = 0.02\n").find("mouth_m"), std::string::npos);
  EXPECT_NE(refusal(kCavity + "modes = 0\n").find("modes"), std::string::npos);
  EXPECT_NE(refusal(kCavity + "modes = 9\n").find("modes"), std::string::npos);
  EXPECT_NE(refusal("[cavity]\nmouth_m = [0, 0, 0.3]\ndiameter_m = -1\n").find("diameter_m"), std::string::npos);
  EXPECT_NE(refusal(kCavity + "neck = 1\n").find("neck"), std::string::npos);
}

modal::Bank with_air() {
  modal::Bank bank = test::single_mode_bank(1000, 3);
  bank.losses = {{.material_per_s = 3}};
  bank.frequency_error = {1e-3};
  bank.shape_error = {0.01};
  bank.radiation->error_db = {0.1};
  bake::HeardMode air{.mode = {102.5, 8.7}, .loss = {.air_per_s = 8.7}, .frequency_error = 2e-3};
  air.field = test::even_field(102.5);
  bake::append_cavity({.mouth_m = {0, 0, 0.3}, .diameter_m = 0.02}, {{air, 3e-3}}, bank);
  return bank;
}

TEST(CavityBank, FileKeepsIt) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(with_air(), folder / "bottle.glb"));
  const auto read = modal::read_bank(folder / "bottle.glb");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_TRUE(read->cavity);
  EXPECT_EQ(read->cavity->mouth_m.z, 0.3);
  EXPECT_EQ(read->cavity->diameter_m, 0.02);
  ASSERT_EQ(read->cavity->modes.size(), 1u);
  EXPECT_EQ(read->cavity->modes[0].mode, 1u);
  EXPECT_EQ(read->cavity->modes[0].flux, 3e-3);
  EXPECT_NEAR(read->frequency_hz[1], 102.5, 1e-5);
  EXPECT_EQ(read->shape(1, 0), (modal::Vec3f{0, 0, 0}));
}

TEST(CavityBank, PackedFileKeepsIt) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(modal::write_bank(with_air(), folder / "bottle.glb", {}, modal::Compression::meshopt));
  const auto read = modal::read_bank(folder / "bottle.glb");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->cavity);
  for (std::size_t p = 0; p < read->point_count(); ++p) EXPECT_EQ(read->shape(1, p), (modal::Vec3f{0, 0, 0}));
}

TEST(CavityBank, ModesAreFollowedWhereABankIsChanged) {
  modal::Bank turned = with_air();
  modal::take_modes(turned, {1, 0});
  EXPECT_EQ(turned.cavity->modes[0].mode, 0u);
  modal::take_modes(turned, {1});
  EXPECT_FALSE(turned.cavity);
  const modal::Bank larger = modal::scaled(with_air(), {.size = 4});
  EXPECT_NEAR(larger.cavity->modes[0].flux / 3e-3, 2, 1e-12);  // as the square root of the size, like far fields
  EXPECT_NEAR(larger.cavity->diameter_m, 0.08, 1e-12);
  EXPECT_NEAR(larger.frequency_hz[1], 102.5 / 4, 0.01);
}

}  // namespace
}  // namespace ringdown::cavity_test
