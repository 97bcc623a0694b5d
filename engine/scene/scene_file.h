// Reads scene files: TOML, described in docs/use/scenes.md. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <filesystem>
#include <string_view>

namespace ringdown::scene {

// Reads and checks a scene. A relative bank path is looked up beside the scene file, then in `presets` (which may be
// empty); banks must exist but are not opened. Fails on an unknown key, a wrong type, a number out of range, or a
// missing bank or name, with one sentence that begins with file:line. World::create() makes the checks that need a
// bank's content.
Result<SceneDescription> read_scene(const std::filesystem::path& path, const std::filesystem::path& presets);

// Reads a scene from memory. `path` is named in errors, and its folder is searched for relative bank paths.
Result<SceneDescription> parse_scene(std::string_view text, const std::filesystem::path& path,
                                     const std::filesystem::path& presets);

}  // namespace ringdown::scene
