#include "engine/bake/object_file.h"

#include "engine/bake/refine.h"
#include "engine/base/toml_table.h"

#include <cmath>

namespace ringdown::bake {
namespace {

constexpr Range kLength_m{1e-9, 1e6};
constexpr Range kGain_db{-60, 60};
constexpr Range kFloor_db{1, 200};
constexpr Range kBudget_s{0.001, 1e6};

void read_options(TomlTable& file, BakeOptions& options) {
  std::string name(fem::element_name(options.element));
  file.text("element", name);
  const Result<fem::Element> element = fem::parse_element(name);
  if (element) options.element = *element;
  if (!element)
    file.complain("element", "element must be \"tet10\", \"tet20\", \"tet35\", \"tet4\" or \"tet4-lumped\"");

  std::uint64_t points = options.most_points, modes = 0;
  file.whole("surface_points", points, 4, 1'000'000);
  file.whole("keep_modes", modes, 0, 1'000'000);
  file.number("floor_db", options.floor_db, kFloor_db);
  options.most_points = points;
  options.keep_modes = static_cast<int>(modes);

  std::vector<double> band = {options.band_low_hz, options.band_high_hz};
  file.numbers("band_hz", band);
  if (band.size() != 2 || !(band[0] >= 0 && band[1] > band[0])) {
    return file.complain("band_hz", "band_hz must be two frequencies in Hz, the lower first");
  }
  options.band_low_hz = band[0];
  options.band_high_hz = band[1];
}

Result<ObjectRecipe> recipe_in(Result<TomlTable> file, const std::filesystem::path& path) {
  if (!file) return fail(file.error());
  ObjectRecipe recipe;
  recipe.name = path.stem().string();
  std::string geometry;
  file->require({"material", "geometry"});
  file->text("name", recipe.name);
  file->text("description", recipe.description);
  file->text("material", recipe.material);
  file->text("geometry", geometry);
  recipe.geometry = path.parent_path() / geometry;
  double unit_m = 0;
  file->number("unit_m", unit_m, kLength_m);
  if (unit_m > 0) recipe.meshing.unit_m = unit_m;
  file->number("scale", recipe.scale, kScale);
  file->number("mesh_size_m", recipe.meshing.mesh_size_m, kLength_m);
  file->named_numbers("parameters", recipe.meshing.parameters);
  read_options(*file, recipe.options);
  recipe.meshing.order = fem::order_of(recipe.options.element);
  file->fraction("error", recipe.error, kError);
  file->number("gain_db", recipe.gain_db, kGain_db);
  file->number("budget_s", recipe.budget_s, kBudget_s);
  if (auto good = file->finish(); !good) return fail(good.error());
  return recipe;
}

}  // namespace

Result<ObjectRecipe> read_object(const std::filesystem::path& path) { return recipe_in(TomlTable::read(path), path); }

Result<ObjectRecipe> parse_object(std::string_view text, const std::filesystem::path& path) {
  return recipe_in(TomlTable::parse(text, path), path);
}

Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress) {
  Result<MaterialEntry> material = find_material(materials, recipe.material);
  if (!material) return fail(material.error());
  for (const auto& [key, value] : recipe.figures) {
    if (auto set = set_figure(material->material, key, value); !set) return fail(set.error());
  }
  Result<BakedObject> object = bake_recipe(recipe, material->material, progress);
  if (object) object->baked.bank.gain = std::pow(10.0, recipe.gain_db / 20);
  return object;
}

}  // namespace ringdown::bake
