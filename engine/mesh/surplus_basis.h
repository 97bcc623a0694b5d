// What polynomials of degree p + 1 have over those of degree p, in a tetrahedron. [any thread]
//
// The shape functions of order p and these together span the polynomials of degree p + 1: for each edge one function,
// for each face p - 1, for the inside (p - 1)(p - 2)/2, all of degree p + 1, zero at the corners, and zero on the edges
// and faces they do not belong to. So a mesh's functions of order p + 1 are those of order p plus these, numbered by
// edges, faces and elements, as long as neighbours agree which corner of an edge or a face is the first: give the
// corners of every element in the same order, say by their numbers in the mesh.
//
// An edge's function is the product of its two coordinates with a Jacobi polynomial, which along the edge makes it an
// integrated Legendre polynomial; faces and the inside likewise (Szabo & Babuska, Finite Element Analysis, 1991,
// chapter 6; Karniadakis & Sherwin, Spectral/hp Element Methods, section 3.2). Such functions are close to orthogonal
// in energy to those of lower degree, which is what makes an estimate from them alone (fem/error_estimate.h) sharp.
#pragma once

#include "engine/mesh/tet_basis.h"

#include <array>

namespace ringdown::mesh {

// Corners of edges and faces, ascending, in the order of the functions.
inline constexpr std::array<std::array<int, 2>, 6> kRisingEdges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
inline constexpr std::array<std::array<int, 3>, 4> kRisingFaces = {{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};

constexpr int surplus_per_face(int order) { return order - 1; }
constexpr int surplus_inside(int order) { return (order - 1) * (order - 2) / 2; }
constexpr int surplus_per_element(int order) { return (order + 2) * (order + 3) / 2; }  // 6, 10, 15, 21

// surplus_per_element values at a point: the six edges', then those of each face, then the inner ones.
// 1 <= order <= kMaxOrder.
Eigen::VectorXd surplus_shape(int order, const Eigen::Vector4d& barycentric);

// Their derivatives by (l1, l2, l3), a row each.
ReferenceGradient surplus_gradient(int order, const Eigen::Vector4d& barycentric);

}  // namespace ringdown::mesh
