// Writes a recorded scene as a program for pictures exports its animations. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/scene/description.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::scene {

// Returns the bytes of a .glb file without any extension: a node with a mesh for each body and static, an ordinary
// material named as that of the body's bank, the paths of the bodies as keyframes, and the camera. `banks` are those of
// the scene's objects, in their order. A body's mesh is the surface of its bank, else its collider; a plane is a slab
// below it, twice as large as the scene's motion. Fails if a body cannot be made.
Result<std::vector<std::byte>> to_picture_glb(const SceneDescription& scene, std::span<const modal::Bank> banks);

}  // namespace ringdown::scene
