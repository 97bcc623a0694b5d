// The tables [orthotropic] and [transversely_isotropic] of a material's file (material_library.h). [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/base/toml_table.h"
#include "engine/modal/bank.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ringdown::bake {

// One of the nine constants, by its key in a file.
struct GrainFigure {
  const char* key;
  double value;
  double table_unit;
};
std::vector<GrainFigure> grain_figures(const modal::Orthotropy& solid);

// Fills `solid` when the file has one of the tables, and `sources` under "grain." and the key.
void read_grain_constants(TomlTable& file, std::optional<modal::Orthotropy>& solid,
                          std::map<std::string, std::string>& sources);

// Sets one of the nine constants; nothing when the material has none, or none of that key.
std::optional<Result<void>> set_grain_constant(modal::Material& material, const std::string& key, double value);

}  // namespace ringdown::bake
