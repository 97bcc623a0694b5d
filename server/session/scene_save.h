// Saves what a session plays as a scene file. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <filesystem>

namespace ringdown::session {

class Session;

// The scene with every object of the session as it is set now, and the bodies that were dropped, each at its time.
// Without a scene: the objects alone.
scene::SceneDescription scene_of(const Session& session);

// Writes scene_of() to `path`. Banks below the file's folder, and presets, get relative paths, others absolute ones.
// Fails when there is nothing to save, and when the file would not load again.
Result<void> save_scene(const Session& session, const std::filesystem::path& path);

}  // namespace ringdown::session
