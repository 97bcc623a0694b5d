// One tetrahedron of order p, 1 to 4: its nodes, and the map that gives it its shape in space. [any thread]
//
// A point of the reference tetrahedron has barycentric coordinates l0 + l1 + l2 + l3 = 1; its free coordinates are (l1,
// l2, l3). The nodes are the points whose p l_i are whole numbers n_i. An element whose nodes lie at x_a in space maps
// the reference tetrahedron to
//
//   x(l) = sum_a N_a(l) x_a,   N_a(l) = P_n0(l0) P_n1(l1) P_n2(l2) P_n3(l3),   P_n(x) = product over k < n of
//                                                                                       (p x - k) / (k + 1)
//
// where N_a is 1 at node a and 0 at all other nodes (Silvester, Int. J. Eng. Sci. 7, 1969). Meshes need the map for the
// geometry of curved elements; finite elements (engine/fem) also use the N_a as shape functions.
//
// Order of the nodes: the four corners; for each edge of kTetEdges its inner nodes, from the first corner to the
// second; for each face of kTetFaces its inner nodes (order 4: the one nearest to the face's first corner first); the
// inner nodes. Up to order 2 this is VTK's and CalculiX's order. gmsh's order differs; gmsh_reader.cpp converts it.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::mesh {

inline constexpr int kMaxOrder = 4;

inline constexpr std::array<std::array<int, 2>, 6> kTetEdges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

// The face opposite each corner, counter-clockwise from outside.
inline constexpr std::array<std::array<int, 3>, 4> kTetFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Returns 4, 10, 20 or 35, the number of polynomials of degree `order` in three variables.
constexpr int nodes_per_element(int order) { return (order + 1) * (order + 2) * (order + 3) / 6; }

// Inner nodes of an edge, of a face, of an element.
constexpr int nodes_per_edge(int order) { return order - 1; }
constexpr int nodes_per_face(int order) { return (order - 1) * (order - 2) / 2; }
constexpr int nodes_inside(int order) { return (order - 1) * (order - 2) * (order - 3) / 6; }

// Returns the order whose elements have this number of nodes; 0 if there is none up to kMaxOrder.
int order_of_nodes(Eigen::Index nodes);

// In all functions below 1 <= order <= kMaxOrder, and n = nodes_per_element(order).

using Barycentric = Eigen::Matrix<double, Eigen::Dynamic, 4>;  // a point in each row
using ReferenceGradient = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Corners = Eigen::Matrix<double, 4, 3>;
// n x 3 [m], the nodes of one element in their order; stored without heap allocation.
using ElementNodes = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, nodes_per_element(kMaxOrder), 3>;

// The nodes of the reference tetrahedron, n x 4.
Barycentric reference_nodes(int order);

// Returns for each point the element's node that lies there; -1 if there is none. This converts elements whose nodes
// are in another order, or whose corners are exchanged, to our order.
std::vector<int> nodes_at(int order, const Barycentric& points);

// n values N_a at a point. They sum to 1.
Eigen::VectorXd interpolation(int order, const Eigen::Vector4d& barycentric);

// n x 3: dN_a / d(l1, l2, l3) at a point.
ReferenceGradient interpolation_gradient(int order, const Eigen::Vector4d& barycentric);

// d(x, y, z) / d(l1, l2, l3), rows l, columns x. For straight elements it is x_i - x_0 everywhere.
Eigen::Matrix3d jacobian(const Corners& corners);
Eigen::Matrix3d jacobian(const ElementNodes& nodes, const ReferenceGradient& gradient);

// The nodes of a straight element of that order.
ElementNodes straight_nodes(int order, const Corners& corners);

// Returns true if every node is where it would be in a straight element (to 1e-9 of the longest edge). The element is
// then an affine image of the reference element, and cheap exact integrals exist.
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
