// Rotations (engine/base/rotation.h) under the names that scenes use. [any thread]
#pragma once

#include "engine/base/rotation.h"
#include "engine/scene/description.h"

namespace ringdown::scene {

using ringdown::about;
using ringdown::inverse;
using ringdown::Matrix3;
using ringdown::norm;
using ringdown::normalized;
using ringdown::product;
using ringdown::to_matrix;
using ringdown::transpose;

// Returns the pose of the listener's frame.
Pose listener_pose(const ListenerDescription& listener);

}  // namespace ringdown::scene
