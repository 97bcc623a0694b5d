// Liquids as text: presets/liquids/NAME.toml. [worker]
//
//   name = "water"
//   description = "Water at 20 degrees"
//   [density_kg_m3]          # and [sound_speed_m_s], [viscosity_pa_s]
//   value = 998.2
//   source = "where the figure is from, or that it is our choice and why"
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <string>

namespace ringdown::liquid {

struct Liquid {
  std::string name;
  double density_kg_m3 = 0;
  double sound_speed_m_s = 0;
  double viscosity_pa_s = 0;
};

// Checks that the name is the file's and that every figure is in its range and has its source.
Result<Liquid> read_liquid(const std::filesystem::path& path);

// `folder`/`name`.toml; when there is none, the error lists those that are there.
Result<Liquid> find_liquid(const std::filesystem::path& folder, const std::string& name);

}  // namespace ringdown::liquid
