#include "engine/bake/material_library.h"

#include "engine/bake/toml_table.h"
#include "engine/fem/elastic.h"

#include <algorithm>
#include <cmath>

namespace ringdown::bake {
namespace {

double sourced_number(TomlTable& file, const std::string& key, MaterialEntry& entry) {
  TomlTable figure = file.table(key);
  const std::string source = figure.text("source");
  if (source.empty()) figure.refuse("source", "must say where the figure is from");
  entry.sources[key] = source;
  const double value = figure.number("value");
  if (!std::isfinite(value)) figure.refuse("value", "must be a finite number");
  return value;
}

}  // namespace

Result<MaterialEntry> read_material(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file.error());
  MaterialEntry entry;
  modal::Material& material = entry.material;
  material.name = file->text("name");
  entry.description = file->text("description");
  if (material.name != path.stem()) file->refuse("name", "must be the file's name, " + path.stem().string());
  material.youngs_modulus_pa = sourced_number(*file, "youngs_modulus_pa", entry);
  material.poisson_ratio = sourced_number(*file, "poisson_ratio", entry);
  material.density_kg_m3 = sourced_number(*file, "density_kg_m3", entry);
  material.damping.alpha_per_s = sourced_number(*file, "alpha_per_s", entry);
  material.damping.beta_s = sourced_number(*file, "beta_s", entry);
  if (material.damping.alpha_per_s < 0) file->refuse("alpha_per_s", "must not be negative");
  if (material.damping.beta_s < 0) file->refuse("beta_s", "must not be negative");
  if (auto good = file->finish(); !good) return fail(good.error());
  const auto stable = fem::check_elastic({material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3});
  if (!stable) return fail(path.string() + ": " + stable.error().message);
  return entry;
}

Result<MaterialEntry> find_material(const std::filesystem::path& folder, const std::string& name) {
  const std::vector<std::string> known = names_in(folder);
  if (std::find(known.begin(), known.end(), name) != known.end()) return read_material(folder / (name + ".toml"));
  if (known.empty())
    return fail("there are no materials in " + folder.string() + "; name their folder with --materials");
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
  return fail("there is no material '" + name + "' in " + folder.string() + "; choose one of: " + list);
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
    if (file.path().extension() == ".toml") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace ringdown::bake
