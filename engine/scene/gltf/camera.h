// The camera of a glTF document as the listener of a scene, and as the view of its window. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"
#include "engine/scene/gltf/animation.h"

#include <optional>
#include <string>

namespace ringdown::scene {

// Adds the camera of the animations' document that is called `name`: its own name, its node's or that of a node above.
// Without a name it is the first one, if there is any. The listener follows an animated camera. Fails if no camera has
// the name.
Result<void> add_camera(GltfAnimations& animations, const std::optional<std::string>& name, SceneDescription& scene);

}  // namespace ringdown::scene
