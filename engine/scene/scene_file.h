// Scenes on disk: TOML, described in docs/scenes.md. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <filesystem>
#include <string_view>

namespace ringdown::scene {

// Reads and checks a scene. A relative bank path is looked for beside the scene file, then in `presets` (which may be
// empty); banks must exist but are not opened. An unknown key, a wrong type, a number out of range, a missing bank or
// name gives one sentence that begins with file:line. What needs the bank's content is checked by World::create().
Result<SceneDescription> read_scene(const std::filesystem::path& path, const std::filesystem::path& presets);

// The same from memory; `path` stands in messages, and its folder is where relative banks are looked for.
Result<SceneDescription> parse_scene(std::string_view text, const std::filesystem::path& path,
                                     const std::filesystem::path& presets);

}  // namespace ringdown::scene
