// The change of a body's frequencies under a small change of its shape. [any thread]
//
// Where the surface moves outward by g(x), to first order
//
//   lambda' = lambda + integral over the surface of g (sigma : epsilon - lambda rho |phi|^2) dS
//
// for a mode phi of unit modal mass: material that is added keeps its strain energy and its kinetic energy, and
// lambda is the ratio of the two (Hadamard's formula for a free boundary; Sokolowski & Zolesio, Introduction to Shape
// Optimization, 1992, section 3.5). Nothing pulls at a free surface, so sigma : epsilon there is that of a plane state
// of stress, which the strains along the surface determine. The shapes at the surface's nodes are all it takes.
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/boundary.h"
#include "engine/mesh/face_points.h"

#include <Eigen/Core>

namespace ringdown::fem {

// Changes of lambda, m numbers. `points` are face_points() of the mesh, `gaps` how far the surface moves outward at
// each of them, in the mesh's unit of length; lambda has m numbers, and the columns of `shapes` (3P x m) are of unit
// modal mass, at the nodes of `surface`, which is boundary_of() the mesh. Where the surface is held, it is taken to be
// free. O(N n m).
Eigen::VectorXd lambda_changes(const mesh::FacePoints& points, const mesh::Boundary& surface,
                               const Eigen::Ref<const Eigen::VectorXd>& gaps, const Solid& solid,
                               const Eigen::Ref<const Eigen::VectorXd>& lambda,
                               const Eigen::Ref<const Eigen::MatrixXd>& shapes);

}  // namespace ringdown::fem
