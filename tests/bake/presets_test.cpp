// The text files: strict reading, and that every preset in the repository is whole.
#include "engine/bake/bake_object.h"
#include "engine/bake/input_hash.h"
#include "engine/bake/recipe_options.h"
#include "engine/materials/material_library.h"
#include "engine/modal/bank_file.h"
#include "tests/bake/clay.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

namespace ringdown::presets_test {
namespace {

namespace fs = std::filesystem;
using test::kGood;
using test::TemporaryFolder;
using test::with;

const fs::path kPresets = fs::path(RINGDOWN_SOURCE_DIR) / "presets";

TEST(MaterialFile, AMaterialFileReadsWhatItSays) {
  const TemporaryFolder folder;
  const auto entry = bake::read_material(folder.write("clay.toml", kGood));
  ASSERT_TRUE(entry) << entry.error().message;
  EXPECT_EQ(entry->material.youngs_modulus_pa, 1e9);
  EXPECT_EQ(entry->material.damping.beta_s, 1e-7);
  EXPECT_EQ(entry->sources.at("beta_s"), "a guess");
}

TEST(MaterialFile, AMaterialFileRefusesMistakesByLine) {
  struct Mistake {
    const char *what, *instead, *complaint;
  };
  const Mistake mistakes[] = {
      {"value = 1e9", "value = = 1e9", ":4: not TOML"},
      {"value = 1e9", "value = \"much\"", ":4: [youngs_modulus_pa]: value must be a number"},
      {"value = 1e9", "valeu = 1e9", ":3: [youngs_modulus_pa]: the key value is missing"},
      {"description = \"A test\"", "description = 3", ":2: description must be a text"},
      {"description", "colour = \"red\"\ndescription", ":2: unknown key 'colour'"},
      {"value = 0.3", "value = 0.3\nunit = \"1\"", ":8: [poisson_ratio]: unknown key 'unit'"},
      {"source = \"a guess\"", "source = \"\"", ":14: [alpha_per_s]: source must be a text in quotes, not empty"},
      {"value = 1\n", "value = -1\n", ":13: [alpha_per_s]: value = -1 is outside 0"},
      {"value = 1e9", "value = nan", ":4: [youngs_modulus_pa]: value = nan is outside"},
      {"value = 0.3", "value = 0.5", ":1: Poisson's ratio must lie between"},
      {"name = \"clay\"", "name = \"mud\"", ":1: name must be the file's, 'clay'"},
      {"[beta_s]", "[beta]", ":1: the key beta_s is missing"},
  };
  const TemporaryFolder folder;
  for (const Mistake& mistake : mistakes) {
    const auto entry = bake::read_material(folder.write("clay.toml", with(kGood, mistake.what, mistake.instead)));
    ASSERT_FALSE(entry) << mistake.instead;
    const std::string begin = (folder.path() / "clay.toml").string() + mistake.complaint;
    EXPECT_TRUE(entry.error().message.starts_with(begin)) << entry.error().message;
  }
}

const std::string kCurve = R"([[loss_factor]]
frequency_hz = 100
eta = 0.02
source = "a paper"
[[loss_factor]]
frequency_hz = 1000
eta = 0.01
source = "a paper"
)";

std::string with_curve(const std::string& curve) { return kGood.substr(0, kGood.find("[alpha_per_s]")) + curve; }

TEST(MaterialFile, RayleighsConstantsAreFittedToALossFactorAtSeveralFrequencies) {
  const TemporaryFolder folder;
  const auto entry = bake::read_material(folder.write("clay.toml", with_curve(kCurve)));
  ASSERT_TRUE(entry) << entry.error().message;
  ASSERT_EQ(entry->material.loss_factors.size(), 2u);
  // Least squares of relative errors over seven octaves: none of them is off by more than a factor of three.
  for (double frequency_hz = 125; frequency_hz <= 8000; frequency_hz *= 2) {
    const double eta = modal::loss_factor_at(entry->material.loss_factors, frequency_hz);
    EXPECT_NEAR(std::log(modal::loss_factor(entry->material.damping, frequency_hz) / eta), 0, std::log(3));
  }
  EXPECT_EQ(entry->sources.at("beta_s"), entry->sources.at("alpha_per_s"));
  EXPECT_EQ(entry->sources.at("beta_s"),
            "fitted to the loss factor 0.02 at 100 Hz, 0.01 at 1000 Hz at the octaves from 125 Hz to 8 kHz: a paper");
}

TEST(MaterialFile, AMaterialFileRefusesALossFactorThatFixesNothing) {
  const TemporaryFolder folder;
  std::string many;
  for (std::size_t i = 0; i < modal::kMaxLossFactors; ++i) {
    many += "[[loss_factor]]\nfrequency_hz = " + std::to_string(i + 1) + "\neta = 0.1\nsource = \"a\"\n";
  }
  EXPECT_TRUE(bake::read_material(folder.write("clay.toml", with_curve(many))));
  const std::pair<std::string, const char*> mistakes[] = {
      {kGood + kCurve, "not both"},
      {with_curve(kCurve + kCurve), "there are two at 100 Hz"},
      {with_curve(with(kCurve, "= 1000", "= 100")), "there are two at 100 Hz"},
      {with_curve(with(kCurve, "eta = 0.02", "eta = 0")), "[[loss_factor]]: eta = 0 is outside"},
      {with_curve(with(kCurve, "eta = 0.02\n", "")), "the key eta is missing"},
      {with_curve(with(kCurve, "= 100\n", "= -1\n")), "frequency_hz = -1 is outside"},
      {with_curve(many + kCurve), "at most 64 loss factors"},
      {"uncertainty = 0.5\n" + with_curve(kCurve), "uncertainty = 0.5 is outside"},
      {with_curve(kCurve + "[thermal.expansion_per_k]\nvalue = 1e-5\nsource = \"a\"\n"),
       "conductivity_w_mk is missing"},
  };
  for (const auto& [text, complaint] : mistakes) {
    const auto entry = bake::read_material(folder.write("clay.toml", text));
    ASSERT_FALSE(entry) << complaint;
    EXPECT_NE(entry.error().message.find(complaint), std::string::npos) << entry.error().message;
  }
}

TEST(MaterialFile, OneLossFactorHoldsEverywhereAndHeatIsKnownByThreeFigures) {
  const TemporaryFolder folder;
  const std::string text = with_curve(kCurve.substr(0, kCurve.find("[[", 2))) +
                           "[thermal.expansion_per_k]\nvalue = 1e-5\nsource = \"a\"\n"
                           "[thermal.conductivity_w_mk]\nvalue = 2\nsource = \"b\"\n"
                           "[thermal.heat_capacity_j_kgk]\nvalue = 900\nsource = \"c\"\n";
  const auto entry = bake::read_material(folder.write("clay.toml", text));
  ASSERT_TRUE(entry) << entry.error().message;
  ASSERT_EQ(entry->material.loss_factors.size(), 1u);
  for (const double frequency_hz : {10.0, 100.0, 1e4}) {
    const double omega = modal::hz_to_rad_per_s(frequency_hz);
    EXPECT_NEAR(modal::mode_loss(entry->material.damping_law(), omega * omega).material_per_s, 0.5 * 0.02 * omega,
                1e-9 * omega);
  }
  EXPECT_EQ(entry->material.thermal, (modal::Thermal{1e-5, 2, 900}));
  EXPECT_EQ(entry->sources.at("conductivity_w_mk"), "b");
}

TEST(MaterialFile, AnUnknownNameListsTheKnownOnes) {
  const auto entry = bake::find_material(kPresets / "materials", "kryptonite");
  ASSERT_FALSE(entry);
  EXPECT_NE(entry.error().message.find("bronze"), std::string::npos);
  EXPECT_FALSE(bake::find_material("/nowhere", "steel"));
  EXPECT_FALSE(bake::find_material(kPresets / "materials", "../materials/steel"));
}

TEST(ObjectFile, AnObjectFileRefusesMistakesByLine) {
  const TemporaryFolder folder;
  const std::string good = "material = \"steel\"\ngeometry = \"a.geo\"\n";
  ASSERT_TRUE(bake::read_object(folder.write("a.toml", good)));
  ASSERT_TRUE(bake::read_object(folder.write("a.toml", good + "gain_db = -60\n")));
  ASSERT_TRUE(bake::read_object(folder.write("a.toml", good + "gain_db = 60\n")));
  EXPECT_EQ(bake::read_object(folder.write("a.toml", good + "scale = 1000\n"))->scale, 1000);
  EXPECT_DOUBLE_EQ(bake::read_object(folder.write("a.toml", good + "error = \"0.1%\"\n"))->error, 1e-3);
  EXPECT_DOUBLE_EQ(bake::read_object(folder.write("a.toml", good + "error = 0.002\n"))->error, 2e-3);
  EXPECT_FALSE(bake::read_object(folder.write("a.toml", good))->pitch_hz);
  EXPECT_NEAR(*bake::read_object(folder.write("a.toml", good + "pitch = \"F#3\"\n"))->pitch_hz, 184.9972, 1e-4);
  EXPECT_DOUBLE_EQ(*bake::read_object(folder.write("a.toml", good + "pitch = 966.1\n"))->pitch_hz, 966.1);
  const std::pair<const char*, const char*> mistakes[] = {
      {"pitch = \"H4\"", ":3: pitch must be a note such as"},
      {"pitch = 0.5", ":3: pitch must be a note such as"},
      {"pitch = \"50%\"", ":3: pitch must be a note such as"},
      {"pitch = [440]", ":3: pitch must be"},
      {"element = \"hex8\"", ":3: element must be \"tet10\""},
      {"surface_points = 2.5", ":3: surface_points must be a whole number"},
      {"surface_points = 3", ":3: surface_points must be a whole number >= 4"},
      {"shape_error = \"90%\"", ":3: shape_error"},
      {"floor_db = 0", ":3: floor_db = 0 is outside 1 ... 200"},
      {"keep_modes = 5000000000", ":3: keep_modes must be a whole number >= 0 and <= 1000000"},
      {"band_hz = [20]", ":3: band_hz must be two frequencies"},
      {"band_hz = [\"low\", \"high\"]", ":3: band_hz must be a list of finite numbers"},
      {"unit_m = 0", ":3: unit_m = 0 is outside"},
      {"scale = 1001", ":3: scale = 1001 is outside 0.001 ... 1000"},
      {"scale = 0.0009", ":3: scale = 0.0009 is outside 0.001 ... 1000"},
      {"mesh_size_m = -1", ":3: mesh_size_m = -1 is outside"},
      {"error = \"small\"", ":3: error must be a number or a percentage"},
      {"error = true", ":3: error must be a number or a percentage"},
      {"error = \"60%\"", ":3: error = 0.6 is outside"},
      {"error = 0", ":3: error = 0 is outside"},
      {"budget_s = 0", ":3: budget_s = 0 is outside 0.001 ... 1e+06"},
      {"gain_db = 60.1", ":3: gain_db = 60.1 is outside -60 ... 60"},
      {"gain_db = -61", ":3: gain_db = -61 is outside -60 ... 60"},
      {"gain_db = nan", ":3: gain_db = nan is outside -60 ... 60"},
      {"colour = 1", ":3: unknown key 'colour'"},
      {"[parameters]\nheight = \"tall\"", ":4: [parameters]: height must be a finite number"},
  };
  for (const auto& [line, complaint] : mistakes) {
    const auto object = bake::read_object(folder.write("a.toml", good + line + "\n"));
    ASSERT_FALSE(object) << line;
    EXPECT_NE(object.error().message.find(complaint), std::string::npos) << object.error().message;
  }
  EXPECT_FALSE(bake::read_object(folder.path() / "none.toml"));
}

TEST(ObjectFile, TheGuideHasEveryOptionOfAnObjectFile) {
  std::ifstream file(fs::path(RINGDOWN_SOURCE_DIR) / "docs/use/materials.md");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::size_t keys = 0;
  for (const bake::RecipeOption& option : bake::recipe_options()) {
    if (option.key.empty()) continue;
    const std::string key(option.key);
    EXPECT_TRUE(text.find("| `" + key + "` |") != std::string::npos ||
                text.find("| `[" + key + "]` |") != std::string::npos)
        << key;
    ++keys;
  }
  EXPECT_GE(keys, 18u);
}

// A linear amplitude of 1/2 is -6.0206 dB. The shapes stay physical: only the bank's gain says how loud it plays.
TEST(ObjectFile, TheGainInDecibelsOfAnObjectFileIsTheBanksLinearOne) {
  const TemporaryFolder folder;
  const auto gain_of = [&](const std::string& line) {
    const std::string text =
        "material = \"steel\"\nunit_m = 0.001\nelement = \"tet4\"\nmesh_size_m = 0.03\nsurface_points = 20\n";
    const auto recipe = bake::read_object(folder.write(
        "a.toml", text + "geometry = \"" + (kPresets / "objects/box.geo").string() + "\"\n" + line + "\n"));
    EXPECT_TRUE(recipe) << recipe.error().message;
    const auto object = bake::bake_object(*recipe, kPresets / "materials");
    EXPECT_TRUE(object) << object.error().message;
    EXPECT_TRUE(modal::write_bank(object->baked.bank, folder.path() / "a.glb"));
    return std::pair(modal::read_bank(folder.path() / "a.glb")->gain, object->baked.bank.shapes.front());
  };
  const auto [plain, shape] = gain_of("");
  const auto [half, same_shape] = gain_of("gain_db = -6.020599913");
  EXPECT_EQ(plain, 1);
  EXPECT_NEAR(half, 0.5, 1e-9);
  EXPECT_EQ(shape, same_shape);
}

TEST(MaterialPage, TheCommittedTableIsInStep) {
  std::ifstream file(fs::path(RINGDOWN_SOURCE_DIR) / "docs/use/materials.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  const auto table = bake::materials_as_markdown(kPresets / "materials");
  ASSERT_TRUE(table) << table.error().message;
  const auto grains = bake::grains_as_markdown(kPresets / "materials");
  ASSERT_TRUE(grains) << grains.error().message;
  const auto strengths = bake::strengths_as_markdown(kPresets / "materials");
  ASSERT_TRUE(strengths) << strengths.error().message;
  EXPECT_NE(page.find("-->\n" + *table + "\n" + *grains + "\n" + *strengths + "<!-- end"), std::string::npos)
      << "run: ./run docs";
}

TEST(MaterialPage, ThePageSaysWhichFiguresToDoubt) {
  const TemporaryFolder folder;
  std::string text = with(kGood, "source = \"a guess\"", "source = \"our choice: none\"");
  text = with(text, "source = \"a book\"", "source = \"a book; to be checked against the original\"");
  (void)folder.write("clay.toml", text);
  const auto page = bake::materials_as_markdown(folder.path());
  ASSERT_TRUE(page);
  // d = (1 + 1e-7 (2000 pi)^2) / 2 = 2.474 1/s, and 6.908 / 2.474 = 2.79
  // eta = 1 / omega + 1e-7 omega
  EXPECT_NE(page->find("| `clay` | 1 ? | 0.3 | 1000 | 0.0017 | 0.00079 | 0.0063 | | | | | 2.8 |\n"), std::string::npos)
      << *page;
  (void)folder.write("clay.toml", "uncertainty = 2\n" + with_curve(with(kCurve, "\"a paper\"", "\"our choice\"")));
  const auto curved = bake::materials_as_markdown(folder.path());
  ASSERT_TRUE(curved);
  EXPECT_NE(curved->find("| *0.02* | *0.01* | *0.01* | 2 | | | | 0.22 |\n"), std::string::npos) << *curved;
  EXPECT_FALSE(bake::materials_as_markdown(folder.path() / "none"));
}

TEST(Presets, EveryMaterialIsWholeAndSourced) {
  const auto check = [](const fs::path& folder, std::size_t& count) {
    const auto names = bake::names_in(folder);
    count = names.size();
    for (const std::string& name : names) {
      const auto entry = bake::read_material(folder / (name + ".toml"));
      EXPECT_TRUE(entry) << (entry ? "" : entry.error().message);
      ASSERT_TRUE(entry);
      const auto of_grain = static_cast<std::size_t>(
          std::ranges::count_if(entry->sources, [](const auto& source) { return source.first.starts_with("grain."); }));
      const std::size_t thermal = entry->material.thermal ? 3 : 0, area = entry->sources.count("strength_area_m2");
      const std::size_t brittle = entry->material.brittleness ? 3 + area : 0;
      EXPECT_EQ(entry->sources.size() - of_grain, 5 + thermal + brittle) << name;
      EXPECT_EQ(of_grain >= 5, entry->material.orthotropy.has_value()) << name;
    }
  };
  std::size_t ours = 0, reports = 0;
  check(kPresets / "materials", ours);
  check(kPresets / "materials/report-2011", reports);
  EXPECT_GE(ours, 25u);
  EXPECT_EQ(reports, 5u);
}

// Table 3.1 as E and nu; its metal is its aluminium again.
TEST(Presets, TheReportsMaterialsKeepItsConstants) {
  const auto elastic = [](const std::string& name) {
    const modal::Material m = bake::find_material(kPresets / "materials/report-2011", "report-" + name)->material;
    return std::pair(m.youngs_modulus_pa / 1e9, m.poisson_ratio);
  };
  EXPECT_EQ(elastic("ceramic"), std::pair(5.45, 0.33));
  EXPECT_EQ(elastic("plastic"), std::pair(34.1, 0.33));
  EXPECT_EQ(elastic("aluminium"), std::pair(68.1, 0.33));
  EXPECT_EQ(elastic("wood"), std::pair(0.283, 0.417));
  EXPECT_EQ(elastic("metal"), elastic("aluminium"));
}

// Names below presets/objects, those in its folders with them: "bell", "vibraphone/F3".
std::vector<std::string> object_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(kPresets / "objects")) {
    if (entry.path().extension() != ".toml") continue;
    names.push_back(fs::relative(entry.path(), kPresets / "objects").replace_extension().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Presets, EveryBankHasItsObject) {
  const auto names = object_names();
  std::uintmax_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kPresets / "banks")) {
    if (entry.path().extension() != ".glb") continue;
    bytes += entry.file_size();
    const std::string name = fs::relative(entry.path(), kPresets / "banks").replace_extension().string();
    EXPECT_TRUE(std::binary_search(names.begin(), names.end(), name)) << name << " has no object";
  }
  EXPECT_LE(bytes, 22'800'000u);
}

// A bank is what a bake of its object would be: `./run presets`, which gives these two options, bakes none again.
TEST(Presets, EveryBankIsOfItsObjectAsItStands) {
  for (const std::string& name : object_names()) {
    const fs::path file = kPresets / "objects" / (name + ".toml");
    const auto object = bake::read_object(file);
    ASSERT_TRUE(object) << object.error().message;
    const auto hash = bake::input_hash({.object = file,
                                        .geometry = object->geometry,
                                        .material = kPresets / "materials" / (object->material + ".toml"),
                                        .options = {"--radiation", "--compress"},
                                        .part_materials = bake::part_materials(*object, kPresets / "materials")});
    const fs::path bank = kPresets / "banks" / (name + ".glb");
    EXPECT_EQ(modal::read_input_hash(bank), hash) << name;
    EXPECT_EQ(modal::read_bank(bank)->pitch_hz, object->pitch_hz) << name;
  }
}

// Every mode that was counted in the band is in the bank or was dropped.
void expect_every_counted_mode(const std::string& name, const bake::BakeOptions& options, const modal::Bank& bank) {
  const std::size_t of_air = bank.cavity ? bank.cavity->modes.size() : 0;
  const auto in_band = static_cast<std::size_t>(bank.provenance.counted_modes - bank.provenance.rigid_modes) + of_air;
  const std::size_t below_band = name == "thunder-sheet" ? 4 : 0;
  const std::size_t modes = bank.mode_count() + static_cast<std::size_t>(bank.provenance.dropped_modes) + below_band;
  const std::size_t tubes = options.resonators.size();  // each has one to three modes beside the body's
  EXPECT_EQ(bank.provenance.resonators.size(), tubes) << name;
  EXPECT_GE(modes, in_band + tubes) << name;
  EXPECT_LE(modes, in_band + 3 * tubes) << name;
  const std::size_t kept = options.keep_modes > 0 ? options.keep_modes : in_band;
  if (tubes == 0) {
    EXPECT_EQ(bank.mode_count(), std::min(kept, in_band)) << name;
  }
}

TEST(Presets, EveryObjectHasItsBank) {
  const auto names = object_names();
  EXPECT_GE(bake::names_in(kPresets / "objects").size(), 26u);
  for (const std::string& name : names) {
    const auto object = bake::read_object(kPresets / "objects" / (name + ".toml"));
    ASSERT_TRUE(object) << object.error().message;
    EXPECT_TRUE(fs::is_regular_file(object->geometry)) << object->geometry;
    EXPECT_GT(object->budget_s, 0) << name << ": ./run presets --check holds its bake against it";
    const auto material = bake::find_material(kPresets / "materials", object->material);
    ASSERT_TRUE(material) << material.error().message;

    const fs::path file = kPresets / "banks" / (name + ".glb");
    const auto bank = modal::read_bank(file);
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_LE(fs::file_size(file), 2'000'000u);
    EXPECT_EQ(bank->name, object->name);
    EXPECT_EQ(bank->frequency_error.size(), bank->mode_count()) << name << ": a bake writes estimates";
    ASSERT_TRUE(bank->material);
    const auto& supports = object->options.makeup.supports;
    EXPECT_EQ(bank->held, !std::ranges::all_of(supports, &bake::Support::only_damps)) << name;
    EXPECT_EQ(bank->provenance.rigid_modes, bank->held ? 0 : 6) << name;
    EXPECT_EQ(bank->material->orthotropy.has_value(), object->options.makeup.grain.has_value()) << name;
    if (bank->provenance.liquids.empty()) {
      expect_every_counted_mode(name, object->options, *bank);
    } else {
      EXPECT_EQ(bank->provenance.counted_modes, 0) << name << ": the count was of the dry body's";
    }
    const auto amplitudes = modal::error_spread(bank->shape_error);
    ASSERT_TRUE(amplitudes) << name;
    EXPECT_LE(amplitudes->median, 0.03) << name;
    EXPECT_LE(amplitudes->largest, 0.1) << name;
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

TEST(Presets, TheVibraphoneIsInTune) {
  constexpr std::array kNames = {"C", "Cs", "D", "Ds", "E", "F", "Fs", "G", "Gs", "A", "As", "B"};
  for (int note = 53; note <= 89; ++note) {
    const std::string name = kNames[note % 12] + std::to_string(note / 12 - 1);
    const fs::path file = kPresets / "banks/vibraphone" / (name + ".glb");
    const auto bank = modal::read_bank(file);
    ASSERT_TRUE(bank) << bank.error().message;
    EXPECT_LE(fs::file_size(file), 92'000u);
    for (const double partial : {1.0, 4.0, 10.0}) {
      const double wanted = partial * 440 * std::exp2((note - 69) / 12.0);
      double nearest = 1e9;
      for (const double f : bank->frequency_hz) nearest = std::min(nearest, std::abs(1200 * std::log2(f / wanted)));
      EXPECT_LE(nearest, 3) << name << ", partial " << partial;
    }
    EXPECT_NEAR(1200 * std::log2(lowest("vibraphone/" + name) / (440 * std::exp2((note - 69) / 12.0))), 0, 3) << name;
  }
}

TEST(Presets, TheTubeRingsAsABeam) {
  const double speed = std::sqrt(72e9 / 2700), gyration = std::sqrt(16.0 * 16 + 14 * 14) / 2 * 1e-3, k = 4.730041 / 0.6;
  const double euler = k * k * gyration * speed / (2 * M_PI);
  const double shear = 2 * (1 + 0.34) / 0.53;  // E / (kappa G); kappa of a thin tube is about 0.53 (Cowper 1966)
  EXPECT_NEAR(lowest("chime-tube") / (euler / std::sqrt(1 + std::pow(k * gyration, 2) * (1 + shear))), 1, 1e-2);
}

// Euler-Bernoulli: f = k^2 / 2 pi * gyration * speed. Both are 25 times and more as long as thick.
TEST(Presets, TheRodAndTheSlatRingAsSlenderBeams) {
  const double rod = std::pow(4.730041 / 0.3, 2) * 0.012 / 4 * std::sqrt(210e9 / 7800) / (2 * M_PI);
  EXPECT_NEAR(lowest("steel-rod") / rod, 1, 1e-2);
  const double slat = std::pow(4.730041 / 0.15, 2) * 0.003 / std::sqrt(12.0) * std::sqrt(72e9 / 2530) / (2 * M_PI);
  EXPECT_NEAR(lowest("glass-slat") / slat, 1, 1e-2);
}

// A clamped tine has its modes at 1 : 6.27; the yoke gives way a little (Rossing, Russell & Brown, Am. J. Phys. 60,
// 1992).
TEST(Presets, TheTuningForkSoundsItsNoteAndItsClang) {
  const auto bank = modal::read_bank(kPresets / "banks/tuning-fork.glb").value();
  EXPECT_NEAR(1200 * std::log2(lowest("tuning-fork") / 440), 0, 3);
  double nearest = 1e9;
  for (const double f : bank.frequency_hz) nearest = std::min(nearest, std::abs(f / 440 - 6.27));
  EXPECT_LE(nearest, 0.15);
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
}  // namespace ringdown::presets_test
