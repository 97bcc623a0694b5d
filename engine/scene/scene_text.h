// Writes scenes as scene files, which read_scene() reads (scene_file.h). [any thread]
#pragma once

#include "engine/scene/description.h"

#include <string>

namespace ringdown::scene {

// The text of a scene file from which parse_scene() makes the same description, bit for bit. Values that a file may
// leave out are left out. Banks stand in it with the paths that the description has.
std::string to_toml(const SceneDescription& scene);

}  // namespace ringdown::scene
