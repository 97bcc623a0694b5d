#include "engine/bake/object_file.h"

#include "engine/bake/toml_table.h"

#include <chrono>
#include <cmath>

namespace ringdown::bake {
namespace {

// A whole number >= least, or an error noted in the file.
int whole_number(TomlTable& file, const std::string& key, int otherwise, int least) {
  const double value = file.number(key, otherwise);
  if (value == std::floor(value) && value >= least && value <= 1e6) return static_cast<int>(value);
  file.refuse(key, "must be a whole number of at least " + std::to_string(least));
  return otherwise;
}

double positive_number(TomlTable& file, const std::string& key, double otherwise) {
  const double value = file.number(key, otherwise);
  if (file.has(key) && !(value > 0 && std::isfinite(value))) file.refuse(key, "must be a positive number");
  return value;
}

void read_options(TomlTable& file, BakeOptions& options) {
  const Result<fem::Element> element = fem::parse_element(file.text("element", "tet10"));
  if (element) options.element = *element;
  if (!element) file.refuse("element", "must be tet10, tet4 or tet4-lumped");
  options.most_points = static_cast<std::size_t>(whole_number(file, "surface_points", 200, 4));
  options.keep_modes = whole_number(file, "max_modes", 0, 0);
  if (!file.has("band_hz")) return;
  const std::vector<double> band = file.numbers("band_hz");
  if (band.size() != 2 || !(band[0] >= 0 && band[1] > band[0])) {
    file.refuse("band_hz", "must be two frequencies in Hz, the lower first");
    return;
  }
  options.band_low_hz = band[0];
  options.band_high_hz = band[1];
}

}  // namespace

Result<ObjectRecipe> read_object(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file.error());
  ObjectRecipe recipe;
  recipe.name = file->text("name", path.stem().string());
  recipe.description = file->text("description", "");
  recipe.material = file->text("material");
  recipe.geometry = path.parent_path() / file->text("geometry");
  recipe.meshing.unit_m = positive_number(*file, "unit_m", 1);
  recipe.meshing.mesh_size_m = positive_number(*file, "mesh_size_m", 0);
  recipe.meshing.parameters = file->all_numbers("parameters");
  read_options(*file, recipe.options);
  recipe.meshing.order = recipe.options.element == fem::Element::kTet10 ? 2 : 1;
  recipe.gain_db = file->number("gain_db", 0);
  if (auto good = file->finish(); !good) return fail(good.error());
  return recipe;
}

Result<BakedObject> bake_object(const ObjectRecipe& recipe, const std::filesystem::path& materials,
                                const Progress& progress) {
  const Result<MaterialEntry> material = find_material(materials, recipe.material);
  if (!material) return fail(material.error());
  if (progress && !progress("mesh", 0)) return fail(std::string(kCancelled));
  const auto start = std::chrono::steady_clock::now();
  Result<mesh::CheckedMesh> mesh = mesh::read_with_gmsh(recipe.geometry, recipe.meshing);
  if (!mesh) return fail(mesh.error());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  Result<Baked> baked = bake(*mesh, material->material, recipe.options, recipe.name, progress);
  if (!baked) return fail(baked.error());
  return BakedObject{std::move(*baked), std::move(*mesh), seconds};
}

}  // namespace ringdown::bake
