// Places, rotations and cameras in the axes of glTF files, in which y points up. For the writers of scenes. [any
// thread]
#pragma once

#include "engine/base/rotation.h"
#include "engine/gltf/glb.h"
#include "engine/scene/description.h"

namespace ringdown::scene {

// Our (x, y, z) is the file's (x, z, -y).
Vec3 to_file(Vec3 v);
Rotation to_file(const Rotation& q);

modal::Json json_of(Vec3 v);
modal::Json json_of(const Rotation& q);

// Returns the rotation that takes an axis, given as a unit vector, to another unit vector.
Rotation turn_between(Vec3 from, Vec3 to);

// The element of the document's `cameras`, and the node that holds it as camera 0.
modal::Json camera_of(const CameraDescription& camera);
modal::Json camera_node_of(const CameraDescription& camera);

}  // namespace ringdown::scene
