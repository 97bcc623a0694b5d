// Where a tetrahedron lies in space, and how to integrate over it. [any thread]
//
// The reference tetrahedron and the shape functions N_a that map it to x = sum_a N_a x_a are tet_basis.h's.
#pragma once

#include "engine/mesh/tet_basis.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

using Corners = Eigen::Matrix<double, 4, 3>;
// n x 3 [m], the nodes of one element in the order of tet_basis.h; kept without a heap.
using ElementNodes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, nodes_per_element(kMaxOrder), 3>;

// d(x, y, z) / d(l1, l2, l3), rows l, columns x. For straight elements it is x_i - x_0 everywhere.
Eigen::Matrix3d jacobian(const Corners& corners);
Eigen::Matrix3d jacobian(const ElementNodes& nodes, const ReferenceGradient& reference_gradient);

// The nodes of a straight element of that order.
ElementNodes straight_nodes(int order, const Corners& corners);

// True when every node is where it would be in a straight element (to 1e-9 of the longest edge): the element is then an
// affine image of the reference one, and cheap exact integrals exist.
bool is_straight(const ElementNodes& nodes);

struct QuadraturePoint {
  Eigen::Vector4d barycentric;
  double weight;  // the weights of a rule sum to 1: integral = volume * sum w f for a straight element
};

// A rule exact for polynomials up to `degree`: the centroid (1), the symmetric 4-point rule (2), and above
// that the conical product of Gauss-Jacobi rules with ((degree+2)/2)^3 points, all weights positive. Source:
// Stroud, Approximate Calculation of Multiple Integrals, 1971, sections 2.4 and 8.8.
std::vector<QuadraturePoint> tet_quadrature(int degree);

}  // namespace ringdown::mesh
