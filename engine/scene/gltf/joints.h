// Converts joints of a glTF scene (KHR_physics_rigid_bodies) to our joints. [worker]
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/gltf/document.h"

#include <string>

namespace ringdown::scene {

// A node that a joint holds, and the name of the body that it moves with; an empty name is the world.
struct JointEnd {
  const GltfNode& node;
  std::string body;
};

// Adds the joint of `first`'s node to the scene, which must already contain all bodies. `joint` is the node's `joint`
// object. The joint becomes a hinge, a ball joint, a slider or a rigid joint if it leaves exactly that freedom, and
// otherwise a free joint with limits. The document's notes name everything that cannot be reproduced exactly.
void add_joint(GltfDocument& document, const modal::JsonPlace& joint, const JointEnd& first, const JointEnd& second,
               SceneDescription& scene);

}  // namespace ringdown::scene
