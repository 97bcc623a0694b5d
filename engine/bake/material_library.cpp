#include "engine/bake/material_library.h"

#include "engine/base/quoted.h"
#include "engine/base/toml_table.h"
#include "engine/fem/elastic.h"

#include <algorithm>
#include <optional>

namespace ringdown::bake {
namespace {

// What no solid exceeds; fem::check_elastic() is stricter.
constexpr Range kYoungsModulus_pa{1e3, 1e13};
constexpr Range kPoissonRatio{-1, 0.5};
constexpr Range kDensity_kg_m3{0.1, 1e5};
constexpr Range kAlpha_per_s{0, 1e6};
constexpr Range kBeta_s{0, 1};

void read_figure(TomlTable& file, const std::string& key, double& target, const Range& range, MaterialEntry& entry) {
  file.require({key});
  std::optional<TomlTable> figure = file.table(key);
  if (!figure) return;
  figure->require({"value", "source"});
  figure->number("value", target, range);
  figure->text("source", entry.sources[key]);
}

}  // namespace

Result<MaterialEntry> read_material(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file.error());
  MaterialEntry entry;
  modal::Material& material = entry.material;
  file->require({"name", "description"});
  file->text("name", material.name);
  file->text("description", entry.description);
  if (material.name != path.stem())
    file->complain("name", "name must be the file's, " + ringdown::quoted(path.stem().string()));
  read_figure(*file, "youngs_modulus_pa", material.youngs_modulus_pa, kYoungsModulus_pa, entry);
  read_figure(*file, "poisson_ratio", material.poisson_ratio, kPoissonRatio, entry);
  read_figure(*file, "density_kg_m3", material.density_kg_m3, kDensity_kg_m3, entry);
  read_figure(*file, "alpha_per_s", material.damping.alpha_per_s, kAlpha_per_s, entry);
  read_figure(*file, "beta_s", material.damping.beta_s, kBeta_s, entry);
  if (auto good = file->finish(); !good) return fail(good.error());
  const auto stable = fem::check_elastic({material.youngs_modulus_pa, material.poisson_ratio, material.density_kg_m3});
  if (!stable) return fail(path.string() + ":1: " + stable.error().message);
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
