// Saves the objects and the scene of a session as a scene file. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <filesystem>

namespace ringdown::session {

class Session;

// Returns the scene with every object of the session as set now, and the dropped bodies, each at its time. Without a
// scene, returns the objects alone.
scene::SceneDescription scene_of(const Session& session);

// Writes scene_of() to `path`. Banks below the file's folder, and presets, get relative paths, all others absolute
// ones. Fails if there is nothing to save, or if the file could not be loaded again.
Result<void> save_scene(const Session& session, const std::filesystem::path& path);

}  // namespace ringdown::session
