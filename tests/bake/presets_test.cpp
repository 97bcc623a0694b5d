// The text files: strict reading, and that every preset in the repository is whole.
#include "engine/bake/object_file.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ringdown {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

const std::string kGood = R"(name = "clay"
description = "A test"
[youngs_modulus_pa]
value = 1e9
source = "a book"
[poisson_ratio]
value = 0.3
source = "a book"
[density_kg_m3]
value = 1000
source = "a book"
[alpha_per_s]
value = 1
source = "a guess"
[beta_s]
value = 1e-7
source = "a guess"
)";

std::string with(std::string text, const std::string& what, const std::string& instead) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, what.size(), instead);
}

TEST(MaterialFile, ReadsWhatItSays) {
  const TemporaryFolder folder;
  const auto entry = bake::read_material(folder.write("clay.toml", kGood));
  ASSERT_TRUE(entry) << entry.error().message;
  EXPECT_EQ(entry->material.youngs_modulus_pa, 1e9);
  EXPECT_EQ(entry->material.damping.beta_s, 1e-7);
  EXPECT_EQ(entry->sources.at("beta_s"), "a guess");
}

TEST(MaterialFile, RefusesMistakesByLine) {
  struct Mistake {
    const char *what, *instead, *complaint;
  };
  const Mistake mistakes[] = {
      {"value = 1e9", "value = = 1e9", "line 4: not TOML"},
      {"value = 1e9", "value = \"much\"", "line 4: 'value' must be a number"},
      {"value = 1e9", "valeu = 1e9", "line 3: 'youngs_modulus_pa.value' is missing"},
      {"description = \"A test\"", "description = 3", "line 2: 'description' must be text"},
      {"description", "colour = \"red\"\ndescription", "line 2: unknown key 'colour'"},
      {"value = 0.3", "value = 0.3\nunit = \"1\"", "line 8: unknown key 'unit'"},
      {"source = \"a guess\"", "source = \"\"", "line 14: 'alpha_per_s.source' must say where"},
      {"value = 1\n", "value = -1\n", "'alpha_per_s' must not be negative"},
      {"value = 1e9", "value = nan", "line 4: 'youngs_modulus_pa.value' must be a finite number"},
      {"value = 0.3", "value = 0.5", "Poisson's ratio must lie between"},
      {"name = \"clay\"", "name = \"mud\"", "line 1: 'name' must be the file's name, clay"},
      {"[beta_s]", "[beta]", "'beta_s' is missing"},
  };
  const TemporaryFolder folder;
  for (const Mistake& mistake : mistakes) {
    const auto entry = bake::read_material(folder.write("clay.toml", with(kGood, mistake.what, mistake.instead)));
    ASSERT_FALSE(entry) << mistake.instead;
    EXPECT_NE(entry.error().message.find(mistake.complaint), std::string::npos) << entry.error().message;
    EXPECT_NE(entry.error().message.find("clay.toml"), std::string::npos) << entry.error().message;
  }
}

TEST(MaterialFile, AnUnknownNameListsTheKnownOnes) {
  const auto entry = bake::find_material(kPresets / "materials", "kryptonite");
  ASSERT_FALSE(entry);
  EXPECT_NE(entry.error().message.find("bronze"), std::string::npos);
  EXPECT_FALSE(bake::find_material("/nowhere", "steel"));
  EXPECT_FALSE(bake::find_material(kPresets / "materials", "../materials/steel"));
}

TEST(ObjectFile, RefusesMistakesByLine) {
  const TemporaryFolder folder;
  const std::string good = "material = \"steel\"\ngeometry = \"a.geo\"\n";
  ASSERT_TRUE(bake::read_object(folder.write("a.toml", good)));
  const std::pair<const char*, const char*> mistakes[] = {
      {"element = \"hex8\"", "line 3: 'element' must be tet10"},
      {"surface_points = 2.5", "line 3: 'surface_points' must be a whole number"},
      {"surface_points = 3", "line 3: 'surface_points' must be a whole number of at least 4"},
      {"band_hz = [20]", "line 3: 'band_hz' must be two frequencies"},
      {"band_hz = [\"low\", \"high\"]", "line 3: 'band_hz' must be a list of numbers"},
      {"unit_m = 0", "line 3: 'unit_m' must be a positive number"},
      {"mesh_size_m = -1", "line 3: 'mesh_size_m' must be a positive number"},
      {"colour = 1", "line 3: unknown key 'colour'"},
      {"[parameters]\nheight = \"tall\"", "line 4: 'height' must be a number"},
  };
  for (const auto& [line, complaint] : mistakes) {
    const auto object = bake::read_object(folder.write("a.toml", good + line + "\n"));
    ASSERT_FALSE(object) << line;
    EXPECT_NE(object.error().message.find(complaint), std::string::npos) << object.error().message;
  }
  EXPECT_FALSE(bake::read_object(folder.path() / "none.toml"));
}

TEST(Presets, EveryMaterialIsWholeAndSourced) {
  const auto names = bake::names_in(kPresets / "materials");
  int of_the_report = 0;
  for (const std::string& name : names) {
    const auto entry = bake::read_material(kPresets / "materials" / (name + ".toml"));
    ASSERT_TRUE(entry) << entry.error().message;
    EXPECT_EQ(entry->sources.size(), 5u);
    of_the_report += name.starts_with("report-");
  }
  EXPECT_EQ(of_the_report, 5);
  EXPECT_GE(names.size(), 15u);
}

// Table 3.1 as E and nu; its metal is its aluminium again.
TEST(Presets, TheReportsMaterialsKeepItsConstants) {
  const auto elastic = [](const std::string& name) {
    const modal::Material m = bake::find_material(kPresets / "materials", "report-" + name)->material;
    return std::pair(m.youngs_modulus_pa / 1e9, m.poisson_ratio);
  };
  EXPECT_EQ(elastic("ceramic"), std::pair(5.45, 0.33));
  EXPECT_EQ(elastic("plastic"), std::pair(34.1, 0.33));
  EXPECT_EQ(elastic("aluminium"), std::pair(68.1, 0.33));
  EXPECT_EQ(elastic("wood"), std::pair(0.283, 0.417));
  EXPECT_EQ(elastic("metal"), elastic("aluminium"));
}

TEST(Presets, EveryObjectHasItsBank) {
  const auto names = bake::names_in(kPresets / "objects");
  EXPECT_GE(names.size(), 6u);
  for (const std::string& name : names) {
    const auto object = bake::read_object(kPresets / "objects" / (name + ".toml"));
    ASSERT_TRUE(object) << object.error().message;
    EXPECT_TRUE(fs::is_regular_file(object->geometry)) << object->geometry;
    const auto material = bake::find_material(kPresets / "materials", object->material);
    ASSERT_TRUE(material) << material.error().message;

    const fs::path file = kPresets / "banks" / (name + ".glb");
    const auto bank = modal::read_bank(file);
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_LE(fs::file_size(file), 300'000u);
    EXPECT_EQ(bank->provenance.rigid_modes, 6);
    EXPECT_GE(bank->mode_count(), 25u);
    EXPECT_LE(bank->point_count(), object->options.most_points);
    ASSERT_TRUE(bank->material);
    EXPECT_FLOAT_EQ(bank->material->youngs_modulus_pa, material->material.youngs_modulus_pa)
        << name << " was baked with another " << object->material << "; bake the presets again";
    EXPECT_FLOAT_EQ(bank->material->damping.beta_s, material->material.damping.beta_s);
  }
}

// Presets against theory that shares nothing with finite elements.
double lowest(const std::string& name) {
  const auto bank = modal::read_bank(kPresets / "banks" / (name + ".glb")).value();
  return *std::min_element(bank.frequency_hz.begin(), bank.frequency_hz.end());
}

TEST(Presets, TheTubeRingsAsABeam) {
  const double speed = std::sqrt(72e9 / 2700), gyration = std::sqrt(16.0 * 16 + 14 * 14) / 2 * 1e-3, k = 4.730041 / 0.6;
  const double euler = k * k * gyration * speed / (2 * M_PI);
  const double shear = 2 * (1 + 0.34) / 0.53;  // E / (kappa G); kappa of a thin tube is about 0.53 (Cowper 1966)
  EXPECT_NEAR(lowest("chime-tube") / (euler / std::sqrt(1 + std::pow(k * gyration, 2) * (1 + shear))), 1, 1e-2);
}

TEST(Presets, ThePlateRingsAsAKirchhoffPlate) {
  // A free plate's first mode is close to the twist w = x y, whose Rayleigh quotient bounds it from above:
  // energy D (1 - nu) a b over rho h a^3 b^3 / 288.
  const double rigidity = 210e9 * std::pow(0.003, 3) / (12 * (1 - 0.31 * 0.31));
  const double bound = std::sqrt(288 * (1 - 0.31) * rigidity / (7800 * 0.003)) / (0.25 * 0.18) / (2 * M_PI);
  EXPECT_LT(lowest("steel-plate"), bound);
  EXPECT_GT(lowest("steel-plate"), 0.9 * bound);
}

}  // namespace
}  // namespace ringdown
