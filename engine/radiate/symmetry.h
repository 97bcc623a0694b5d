// The mirror planes of a body. [worker]
#pragma once

#include "engine/radiate/body.h"

#include <Eigen/Core>

namespace ringdown::radiate {

// A frame whose first coordinate planes are the body's mirror planes, perpendicular to each other.
struct Symmetry {
  int mirrors = 0;                                     // 0 to 3
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // a rotation; rows are the frame's axes
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();     // a point's coordinates are turn * point - shift
};

// Looks for planes through the middle of the surface. Candidates lie across the axes of coordinates, the principal axes
// and the normals of the largest faces; if two principal axes have similar moments, also across any axis between them.
// A plane counts when the surface's mirror image lies within kMirrorDistance of the surface, rms over the area, in
// addition to the distance of flat triangles from a curved surface. The surface must be closed.
Symmetry symmetry_of(const mesh::TriangleMesh& surface);

// Relative to the radius of a sphere with the surface's area.
inline constexpr double kMirrorDistance = 1e-3;

// The body in the frame of `symmetry`.
Body moved(const Body& body, const Symmetry& symmetry);

}  // namespace ringdown::radiate
