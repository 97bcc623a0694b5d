// Shape functions and quadrature of the tetrahedron. [any thread]
//
// A point of the reference tetrahedron has barycentric coordinates l0 + l1 + l2 + l3 = 1; its free
// coordinates are (l1, l2, l3). With corner shape functions l_i (2 l_i - 1) and edge shape functions 4 l_i
// l_j, a 10-node element maps it to x = sum_a N_a x_a. Source: Zienkiewicz & Taylor, The Finite Element
// Method, vol. 1, section 8.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

using Shape10 = Eigen::Matrix<double, 10, 1>;
using Gradient10 = Eigen::Matrix<double, 10, 3>;
using Nodes10 = Eigen::Matrix<double, 10, 3>;
using Corners = Eigen::Matrix<double, 4, 3>;

// N_a at a point.
Shape10 shape10(const Eigen::Vector4d& barycentric);

// dN_a / d(l1, l2, l3) at a point.
Gradient10 reference_gradient10(const Eigen::Vector4d& barycentric);

// d(x, y, z) / d(l1, l2, l3), rows l, columns x: x_i - x_0 for the straight element.
Eigen::Matrix3d jacobian4(const Corners& corners);
Eigen::Matrix3d jacobian10(const Nodes10& nodes, const Gradient10& reference_gradient);

// True when every edge node is in the middle of its edge (to 1e-9 of the edge): the element is then an affine
// image of the reference one, and cheap exact integrals exist.
bool is_straight(const Nodes10& nodes);

struct QuadraturePoint {
  Eigen::Vector4d barycentric;
  double weight;  // the weights of a rule sum to 1: integral = volume * sum w f for a straight element
};

// A rule exact for polynomials up to `degree`: the centroid (1), the symmetric 4-point rule (2), and above
// that the conical product of Gauss-Jacobi rules with ((degree+2)/2)^3 points, all weights positive. Source:
// Stroud, Approximate Calculation of Multiple Integrals, 1971, sections 2.4 and 8.8.
std::vector<QuadraturePoint> tet_quadrature(int degree);

}  // namespace ringdown::mesh
