// The figures of a brittle material in its file.
#include "engine/materials/material_library.h"
#include "tests/bake/clay.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <string>
#include <tuple>

namespace ringdown::brittle_material_test {
namespace {

using test::kGood;
using test::TemporaryFolder;
using test::with;

const std::string kBrittle = R"([brittle.strength_pa]
value = 4e7
source = "a book"
[brittle.weibull_modulus]
value = 8
source = "our choice: none"
[brittle.toughness_pa_sqrt_m]
value = 1e6
source = "a book"
)";

TEST(MaterialFile, ABrittleMaterialSaysWhenItBreaks) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text) { return bake::read_material(folder.write("clay.toml", text)); };
  EXPECT_FALSE(read(kGood)->material.brittleness) << "ductile";
  const auto plain = read(kGood + kBrittle);
  ASSERT_TRUE(plain) << plain.error().message;
  modal::Material clay = plain->material;
  ASSERT_TRUE(clay.brittleness);
  EXPECT_EQ(clay.brittleness->strength.strength_pa, 4e7);
  EXPECT_EQ(clay.brittleness->strength.weibull_modulus, 8);
  EXPECT_EQ(clay.brittleness->strength.reference_area_m2, 1e-3);
  EXPECT_EQ(clay.brittleness->toughness_pa_sqrt_m, 1e6);
  const auto small = read(kGood + kBrittle + "[brittle.strength_area_m2]\nvalue = 1e-4\nsource = \"a book\"\n");
  ASSERT_TRUE(small) << small.error().message;
  EXPECT_EQ(small->material.brittleness->strength.reference_area_m2, 1e-4);
  EXPECT_TRUE(bake::set_figure(clay, "strength_pa", 5e7));
  EXPECT_EQ(clay.brittleness->strength.strength_pa, 5e7);
  EXPECT_FALSE(bake::set_figure(clay, "weibull_modulus", 0.5));
  modal::Material ductile = read(kGood)->material;
  EXPECT_FALSE(bake::set_figure(ductile, "strength_pa", 5e7));
  // The energy of a crack: 1e12 (1 - 0.09) / 1e9.
  ASSERT_TRUE(read(kGood + kBrittle));
  const auto table = bake::strengths_as_markdown(folder.path());
  ASSERT_TRUE(table);
  EXPECT_NE(table->find("| `clay` | 40 | *8* | 1 | 10 | 9.1e+02 |\n"), std::string::npos) << *table;
}

TEST(MaterialFile, AStrengthThatNoMaterialHasIsRefused) {
  const TemporaryFolder folder;
  const std::tuple<const char*, const char*, const char*> mistakes[] = {
      {"value = 4e7", "value = 0", "[brittle]: strength_pa: value = 0 is outside"},
      {"value = 8", "value = 0.9", "value = 0.9 is outside 1"},
      {"value = 1e6", "value = -1", "value = -1 is outside"},
      {"[brittle.toughness_pa_sqrt_m]", "[brittle.toughness]", "the key toughness_pa_sqrt_m is missing"},
      {"source = \"our choice: none\"", "", "the key source is missing"},
  };
  for (const auto& [what, instead, complaint] : mistakes) {
    const auto entry = bake::read_material(folder.write("clay.toml", kGood + with(kBrittle, what, instead)));
    ASSERT_FALSE(entry) << instead;
    EXPECT_NE(entry.error().message.find(complaint), std::string::npos) << entry.error().message;
  }
}

}  // namespace
}  // namespace ringdown::brittle_material_test
