// The liquids in a body and around it, as [fill] and [bath] of an object file say. [any thread]
//
//   [fill]
//   liquid = "water"             # a file of presets/liquids; default: water
//   level_m = 0.12               # a height along `up`, in metres before `scale`; or depth_m, or volume_ml of
//                                # the object at its scale, or full = true
//   up = [0, 0, 1]               # default
//   basin = [0, 0, 0.066]        # points near the bottoms of the basins that are filled, three numbers each; needed
//                                # only where the body has several basins of like size
//   levels = 16                  # of which the bank keeps matrices, so that the level can change while it sounds; 0:
//   none [bath]                       # it stands in a liquid without bounds liquid = "water" level_m = 0.03 up = [0,
//   0, 1]
#pragma once

#include "engine/base/toml_table.h"
#include "engine/base/vec3.h"
#include "engine/liquid/liquid.h"
#include "engine/liquid/potential.h"
#include "engine/liquid/wet_wall.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace ringdown::bake {

struct Filling {
  liquid::Liquid liquid{.name = "water"};  // its name at first; bake_object() looks it up
  liquid::Amount amount;                   // lengths in metres, the volume in cubic metres
  Vec3 up{0, 0, 1};
  std::vector<Vec3> basins_m;
  std::size_t levels = 0;              // 0, or modal::kMinLevels to kMaxLevels
  int wall_nodes = liquid::kWetNodes;  // of the boundary elements; the time goes with their square
};

struct Bath {
  liquid::Liquid liquid{.name = "water"};
  double level_m = 0;
  Vec3 up{0, 0, 1};
};

struct Liquids {
  std::optional<Filling> fill;
  std::optional<Bath> bath;

  [[nodiscard]] bool none() const { return !fill && !bath; }
  // Returns the same liquids for a body of `scale` times the size.
  [[nodiscard]] Liquids scaled(double scale) const;
};

// The folder of liquids: beside that of materials.
std::filesystem::path liquid_folder(const std::filesystem::path& materials);

// Errors are noted in the file.
void read_liquids(TomlTable& file, Liquids& liquids);

}  // namespace ringdown::bake
