// Rotations as three angles, which people type, and poses that a gizmo changes. Pure arithmetic. [any]
#pragma once

#include "clients/viewer/render/gizmo.h"
#include "engine/base/rotation.h"

#include <array>

namespace ringdown::viewer {

// About z, then about the new y, then about the new x: heading, tilt and roll, in degrees.
using Angles = std::array<double, 3>;
Angles angles_of(const Rotation& rotation);  // heading and roll -180 ... 180, tilt -90 ... 90
Rotation rotation_of(const Angles& degrees);

// Returns the pose after a drag of a gizmo at `centre_m`.
ringdown::Pose changed(const ringdown::Pose& pose, Vec3 centre_m, const Gizmo::Change& change);

}  // namespace ringdown::viewer
