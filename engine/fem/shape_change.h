// The change of a body's frequencies under a small change of its shape. [any thread]
//
// If the surface moves outward by g(x), to first order
//
//   lambda' = lambda + integral over the surface of g (sigma : epsilon - lambda rho |phi|^2) dS
//
// for a mode phi of unit modal mass: added material brings its strain energy and its kinetic energy, and lambda is the
// ratio of both (Hadamard's formula for a free boundary; Sokolowski & Zolesio, Introduction to Shape Optimization,
// 1992, section 3.5). A free surface has no traction, so sigma : epsilon there is that of a plane state of stress,
// which the strains along the surface determine. Only the shapes at the surface's nodes are needed.
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/face_points.h"

#include <Eigen/Core>

namespace ringdown::fem {

// Changes of lambda, m numbers. `points` are face_points() of the mesh; `gaps` has the outward displacement of the
// surface at each point, in the mesh's unit of length. lambda has m numbers. The columns of `shapes` (3P x m) have unit
// modal mass, at the nodes of `surface`, which is boundary_of() the mesh. A held surface is treated as free. O(N n m).
Eigen::VectorXd lambda_changes(const mesh::FacePoints& points, const mesh::Boundary& surface,
                               const Eigen::Ref<const Eigen::VectorXd>& gaps, const Solid& solid,
                               const Eigen::Ref<const Eigen::VectorXd>& lambda,
                               const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace ringdown::fem
