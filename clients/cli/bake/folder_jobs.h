// What there is to bake in a folder. [worker]
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::cli {

struct FolderJob {
  std::string name;              // the path below the folder without its ending: "bell", "kitchen/pan"
  std::filesystem::path input;   // an object (.toml); with_shapes: or a geometry or mesh
  std::filesystem::path output;  // NAME.glb below the output folder
  std::string refused;           // not empty: why it cannot be baked
};

struct FolderContent {
  std::vector<FolderJob> jobs;     // by name
  std::size_t shapes_without = 0;  // geometries and meshes that no object file names, left out for want of a material
};

struct FolderQuestion {
  std::filesystem::path folder, output;
  bool recursive = false;
  bool with_shapes = false;
};

// Every .toml file is an object. With `with_shapes` so is each geometry and mesh, but for those that an object file or
// another geometry reads, and those beside an object file of the same name. Two shapes that differ only in their ending
// would make the same bank: both are refused. A .glb file is never one, as banks are such files. Hidden files and
// folders are passed over. Fails when the folder cannot be read, or has nothing to bake.
Result<FolderContent> content_of(const FolderQuestion& question);

}  // namespace ringdown::cli
