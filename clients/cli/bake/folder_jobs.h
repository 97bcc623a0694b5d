// Finds what can be baked in a folder. [worker]
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
  std::string refused;           // why it cannot be baked; empty when it can
};

struct FolderContent {
  std::vector<FolderJob> jobs;     // by name
  std::size_t shapes_without = 0;  // geometries and meshes left out because no object file gives them a material
};

struct FolderQuestion {
  std::filesystem::path folder, output;
  bool recursive = false;
  bool with_shapes = false;
};

// Every .toml file is an object. With `with_shapes`, every geometry and mesh is one too, except those that an object
// file or another geometry reads and those beside an object file of the same name. Two shapes whose names differ only
// in the ending would make the same bank, so both are refused. .glb files are never objects, because banks are .glb
// files. Hidden files and folders are ignored. Fails when the folder cannot be read or has nothing to bake.
Result<FolderContent> content_of(const FolderQuestion& question);

}  // namespace ringdown::cli
