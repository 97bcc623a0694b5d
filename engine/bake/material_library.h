// Materials as text: presets/materials/NAME.toml. [worker]
//
//   name = "bronze"
//   description = "Bell metal, about 78 % copper and 22 % tin"
//   [youngs_modulus_pa]      # and [poisson_ratio] [density_kg_m3] [alpha_per_s] [beta_s]
//   value = 100e9
//   source = "where the figure is from, or that it is our choice and why"
//
// Every figure has a source. Rayleigh's alpha and beta are seldom published: most are fitted to a loss factor
// eta at one frequency by beta = eta / omega, which the source then says. docs/materials.md lists all of them.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::bake {

// Words in a source that docs/materials.md marks.
inline constexpr std::string_view kOurChoice = "our choice";
inline constexpr std::string_view kToBeChecked = "to be checked against the original";

struct MaterialEntry {
  modal::Material material;
  std::string description;
  std::map<std::string, std::string> sources;  // key of the figure -> where it is from
};

// Checks that the name is the file's, that the constants are a stable solid's, and that every figure has its
// source. A sentence about one figure begins with path:line.
Result<MaterialEntry> read_material(const std::filesystem::path& path);

// `folder`/`name`.toml; when there is none, the error lists those that are there.
Result<MaterialEntry> find_material(const std::filesystem::path& folder, const std::string& name);

// Names of the .toml files in a folder, sorted; empty when there is no such folder.
std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace ringdown::bake
