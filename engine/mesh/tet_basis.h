// The Lagrange tetrahedron of order p, 1 to 4: its nodes, shape functions and their gradients. [any thread]
//
// A point of the reference tetrahedron has barycentric coordinates l0 + l1 + l2 + l3 = 1; its free coordinates are (l1,
// l2, l3). The nodes are the points whose p l_i are whole numbers n_i. The shape function of such a node is 1 there
// and 0 at the others:
//
//   N(l) = P_n0(l0) P_n1(l1) P_n2(l2) P_n3(l3),   P_n(x) = product over k < n of (p x - k) / (k + 1)
//
// (Silvester, Int. J. Eng. Sci. 7, 1969). An element with nodes x_a maps the reference tetrahedron to x = sum_a N_a
// x_a.
//
// Order of the nodes: the four corners; for each edge of kTetEdges its inner nodes, from the first corner to the
// second; for each face of kTetFaces its inner nodes (order 4: the one nearest to the face's first corner first); the
// inner nodes. Up to order 2 that is VTK's and CalculiX's order.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::mesh {

inline constexpr int kMaxOrder = 4;

inline constexpr std::array<std::array<int, 2>, 6> kTetEdges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

// The face opposite each corner, counter-clockwise from outside.
inline constexpr std::array<std::array<int, 3>, 4> kTetFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// 4, 10, 20, 35: polynomials of that degree in three variables.
constexpr int nodes_per_element(int order) { return (order + 1) * (order + 2) * (order + 3) / 6; }

// Inner nodes of an edge, of a face, of an element.
constexpr int nodes_per_edge(int order) { return order - 1; }
constexpr int nodes_per_face(int order) { return (order - 1) * (order - 2) / 2; }
constexpr int nodes_inside(int order) { return (order - 1) * (order - 2) * (order - 3) / 6; }

// The order whose elements have that many nodes; 0 when there is none up to kMaxOrder.
int order_of_nodes(Eigen::Index nodes);

// In all of these 1 <= order <= kMaxOrder; n = nodes_per_element(order).
using Lattice = Eigen::Matrix<double, Eigen::Dynamic, 4>;
using ReferenceGradient = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// n x 4 barycentric coordinates of the nodes.
Lattice lattice(int order);

// Which node of the element lies at each of the points, given as n x 4 barycentric coordinates; -1 where there is none.
// So an element whose nodes come in another order, or with its corners exchanged, is put into ours.
std::vector<int> nodes_at(int order, const Lattice& points);

// n values N_a at a point. They sum to 1.
Eigen::VectorXd shape(int order, const Eigen::Vector4d& barycentric);

// n x 3: dN_a / d(l1, l2, l3) at a point.
ReferenceGradient reference_gradient(int order, const Eigen::Vector4d& barycentric);

}  // namespace ringdown::mesh
