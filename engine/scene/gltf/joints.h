// Joints of a glTF scene (KHR_physics_rigid_bodies) as joints of ours. [worker]
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/gltf/document.h"

#include <string>

namespace ringdown::scene {

// A node that a joint holds, and the body that it moves with; an empty one is the world.
struct JointEnd {
  const GltfNode& node;
  std::string body;
};

// Adds the joint of `first`'s node to the scene, whose bodies must all be there. `joint` is the node's `joint` object.
// A joint becomes a hinge, a ball joint, a slider or a rigid one where it leaves just that freedom, and otherwise a
// free joint with limits. The document's notes say what cannot be made as it stands there.
void add_joint(GltfDocument& document, const modal::Field& joint, const JointEnd& first, const JointEnd& second,
               SceneDescription& scene);

}  // namespace ringdown::scene
