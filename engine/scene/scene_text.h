// Writes scenes as scene files, which read_scene() reads (scene_file.h). [any thread]
#pragma once

#include "engine/scene/description.h"

#include <string>

namespace ringdown::scene {

// Returns the text of a scene file from which parse_scene() makes an identical description, bit for bit. Omits optional
// values that have their defaults. Bank paths are written as they are in the description.
std::string to_toml(const SceneDescription& scene);

}  // namespace ringdown::scene
