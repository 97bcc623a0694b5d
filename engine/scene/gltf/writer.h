// Writes scenes as glTF files with their banks inside, which other programs read (docs/use/gltf-scenes.md). [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/scene/description.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::scene {

// Returns the bytes of a .glb file. `banks` are those of the scene's objects, in their order. Every body, static and
// joint and the camera are written in KHR_physics_rigid_bodies and KHR_audio_rigid_bodies; of an emitter, only its
// first body. The file also contains Ringdown's own scene, from which parse_gltf_scene() makes an identical
// description, bit for bit, unless another program has changed the file. Bodies that may break are written whole, for
// the file has no pieces. If bodies follow paths with poses (recording.h), the file has these as keyframes of kinematic
// bodies, and no scene of Ringdown's own. Fails if a body cannot be made.
Result<std::vector<std::byte>> to_glb(const SceneDescription& scene, std::span<const modal::Bank> banks);

}  // namespace ringdown::scene
