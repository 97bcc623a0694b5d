// Bakes the bodies of a glTF scene that have an acoustic material and no model, and writes the scene again with their
// models. [worker]
//
// Bodies of the same shape, material and mass share one model. A body that cannot be baked stays silent and does not
// stop the others. Every other value and every byte of the buffers stays as it was (engine/modal/gltf_models.h). The
// file is replaced when all is done: a bake that is cancelled leaves it as it was, and what was solved is in the cache.
#pragma once

#include "clients/cli/long_work.h"
#include "engine/bake/object_file.h"
#include "engine/base/result.h"
#include "protocol/exit_codes.h"

#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>

namespace ringdown::cli {

struct SceneBake {
  std::filesystem::path input, output, materials;  // the input may be the output
  // Makes the recipe for baking that geometry from the options of the command line.
  std::function<Result<bake::ObjectRecipe>(const std::filesystem::path& geometry)> recipe_for;
  std::map<std::string, std::string> body_materials;  // of bodies by name, in place of what the file says
  ProgressLine::Style style = ProgressLine::Style::none;
  bool quiet = false;
};

// A .glb or .gltf with acoustic surfaces, or with animated meshes, is a scene, and not a bank or a surface; true for
// such a file.
bool has_surfaces(const std::filesystem::path& path);

// Prints a line for each model and a summary to stdout, and a sentence for each body that failed to stderr. Exit codes:
// bad_input when one failed or the scene cannot be read; failure when it cannot be written; cancelled; ok.
protocol::ExitCode bake_scene(const SceneBake& request, const std::stop_token& stop);

}  // namespace ringdown::cli
