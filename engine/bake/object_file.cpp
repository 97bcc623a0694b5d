#include "engine/bake/object_file.h"

#include "engine/base/toml_table.h"

#include <chrono>
#include <cmath>

namespace ringdown::bake {
namespace {

constexpr Range kLength_m{1e-9, 1e6};
constexpr Range kGain_db{-60, 60};

void read_options(TomlTable& file, BakeOptions& options) {
  std::string name = "tet10";
  file.text("element", name);
  const Result<fem::Element> element = fem::parse_element(name);
  if (element) options.element = *element;
  if (!element) file.complain("element", "element must be \"tet10\", \"tet20\", \"tet35\", \"tet4\" or \"tet4-lumped\"");

  std::uint64_t points = options.most_points, modes = 0;
  file.whole("surface_points", points, 4, 1'000'000);
  file.whole("max_modes", modes, 0, 1'000'000);
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

}  // namespace

Result<ObjectRecipe> read_object(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
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
  file->number("unit_m", recipe.meshing.unit_m, kLength_m);
  file->number("mesh_size_m", recipe.meshing.mesh_size_m, kLength_m);
  file->named_numbers("parameters", recipe.meshing.parameters);
  read_options(*file, recipe.options);
  recipe.meshing.order = fem::order_of(recipe.options.element);
  file->number("gain_db", recipe.gain_db, kGain_db);
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
  baked->bank.gain = std::pow(10.0, recipe.gain_db / 20);
  return BakedObject{std::move(*baked), std::move(*mesh), seconds};
}

}  // namespace ringdown::bake
