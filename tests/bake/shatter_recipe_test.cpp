// [shatter] of an object file: what it says, and which bodies it is refused for.
#include "engine/bake/bake_object.h"
#include "engine/bake/object_file.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace ringdown::shatter_recipe_test {
namespace {

using bake::Shatter;

const modal::Material kGlass{"glass", 70e9, 0.22, 2500, {0.5, 2e-9}};

TEST(ShatterRecipe, ABodyThatIsHeldOrMadeOfSeveralMaterialsIsNotBroken) {
  const auto refusal = [](const bake::Makeup& makeup, int nonlinear) {
    bake::ObjectRecipe recipe{.name = "pane", .geometry = "nowhere.msh", .shatter = Shatter{}};
    recipe.options.makeup = makeup;
    recipe.options.nonlinear = nonlinear;
    const auto baked = bake::bake_recipe(recipe, kGlass);
    return baked ? "accepted" : baked.error().message;
  };
  const std::string end = " cannot be broken; leave [shatter] out, or make it of one free material";
  const std::string held = "pane: a body with a grain, parts, masses or stiff supports" + end;
  EXPECT_EQ(refusal({.supports = {{.kind = bake::SupportKind::kClamped}}}, 0), held);
  EXPECT_EQ(refusal({.supports = {{.kind = bake::SupportKind::kSprings, .stiffness_n_m3 = 1e9}}}, 0), held);
  EXPECT_EQ(refusal({.grain = bake::Grain{}}, 0), held);
  EXPECT_EQ(refusal({.masses = {{.mass_kg = 0.1}}}, 0), held);
  EXPECT_EQ(refusal({}, 3), "pane: a body with nonlinear modes" + end);
  const std::string free = refusal(
      {.supports = {{.kind = bake::SupportKind::kPoints, .points_m = {{0, 0, 0}}, .point_damping_ns_m = 1}}}, 0);
  EXPECT_NE(free.find("nowhere.msh"), std::string::npos) << "what only damps holds nothing: " << free;
}

Result<bake::ObjectRecipe> parsed(const std::string& shatter) {
  return bake::parse_object("material = \"glass\"\ngeometry = \"pane.msh\"\n" + shatter, "pane.toml");
}

TEST(ShatterRecipe, AnObjectFileSaysHowItBreaks) {
  EXPECT_FALSE(parsed("").value().shatter);
  const Shatter plain = parsed("[shatter]\n").value().shatter.value();
  EXPECT_EQ(plain.pieces, std::vector{30});
  EXPECT_TRUE(plain.places_m.empty());
  EXPECT_EQ(plain.pattern, shatter::Pattern::kImpact);
  const Shatter whole = parsed(
                            "[shatter]\npieces = [4, 14, 480]\npattern = \"radial\"\nat = [0.1, 0, 0, 0, -0.2, 0.3]\n"
                            "seed = 7\nmin_mass_kg = 0.001\nband_hz = [100, 16000]\n")
                            .value()
                            .shatter.value();
  EXPECT_EQ(whole.pieces, (std::vector{4, 14, 480}));
  EXPECT_EQ(whole.pattern, shatter::Pattern::kRadial);
  EXPECT_EQ(whole.places_m, (std::vector<Vec3>{{0.1, 0, 0}, {0, -0.2, 0.3}}));
  EXPECT_EQ(whole.seed, 7u);
  EXPECT_EQ(whole.min_mass_kg, 0.001);
  EXPECT_EQ(whole.band_low_hz, 100);
  EXPECT_EQ(whole.band_high_hz, 16000);
  EXPECT_EQ(parsed("[shatter]\npattern = \"uniform\"\n").value().shatter->pattern, shatter::Pattern::kUniform);
}

TEST(ShatterRecipe, AWrongValueIsRefusedWithASentenceThatNamesItsKey) {
  std::string many = "0";
  for (int i = 1; i < 51; ++i) many += ", 0";
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"pieces", "[1]"},       {"pieces", "[]"},        {"pieces", "[3, 2]"},     {"pieces", "[2, 2]"},
      {"pieces", "[2.5]"},     {"pieces", "[501]"},     {"pieces", "[-4]"},       {"pieces", "[2, 3, 4, 5, 6]"},
      {"pieces", "\"many\""},  {"pieces", "[nan]"},     {"pieces", "[1e300]"},    {"pattern", "\"star\""},
      {"pattern", "3"},        {"at", "[0.1, 0.2]"},    {"at", "[2e6, 0, 0]"},    {"at", "[" + many + "]"},
      {"at", "[inf, 0, 0]"},   {"at", "0.1"},           {"seed", "-1"},           {"seed", "1.5"},
      {"seed", "2000000000"},  {"seed", "\"one\""},     {"min_mass_kg", "-1"},    {"min_mass_kg", "1e4"},
      {"min_mass_kg", "true"}, {"band_hz", "[20]"},     {"band_hz", "[200, 20]"}, {"band_hz", "[-1, 20]"},
      {"band_hz", "[0, 2e6]"}, {"band_hz", "[20, 20]"}, {"band_hz", "20000"},     {"strength", "3"},
      {"band_hz", "[20, nan]"}};
  for (const auto& [key, value] : wrong) {
    const auto recipe = parsed("[shatter]\n" + key + " = " + value + "\n");
    ASSERT_FALSE(recipe) << key << " = " << value;
    const std::string& sentence = recipe.error().message;
    EXPECT_EQ(sentence.find("pane.toml:4: "), 0u) << sentence;
    EXPECT_NE(sentence.find(key), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
    EXPECT_LT(sentence.size(), 200u) << sentence;
  }
  const auto number = parsed("shatter = 3\n");
  ASSERT_FALSE(number);
  EXPECT_NE(number.error().message.find("shatter"), std::string::npos);
}

}  // namespace
}  // namespace ringdown::shatter_recipe_test
