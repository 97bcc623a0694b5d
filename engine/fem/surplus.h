// The functions that degree p + 1 adds to the polynomials of degree p: their values in one tetrahedron, their numbers
// over a mesh, and their matrices in one element. Private to the estimate of errors (error_estimate.h). [any thread]
//
// The shape functions of order p and the added ones together span the polynomials of degree p + 1. Each edge adds one
// function, each face p - 1, and the inside (p - 1)(p - 2)/2, all of degree p + 1, zero at the corners, and zero on the
// edges and faces they do not belong to. A mesh's functions of order p + 1 are therefore those of order p plus the
// added ones, numbered by edges, faces and elements. Neighbours must agree which corner of an edge or a face is the
// first: give the corners of every element in one order, for example by their numbers in the mesh.
//
// An edge's function is the product of its two coordinates with a Jacobi polynomial, which along the edge makes it an
// integrated Legendre polynomial; the functions of faces and of the inside are built in a similar way (Szabo & Babuska,
// Finite Element Analysis, 1991, chapter 6; Karniadakis & Sherwin, Spectral/hp Element Methods, section 3.2). Such
// functions are close to orthogonal in energy to those of lower degree, so an estimate from them alone is sharp.
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/tet_element.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::fem {

// Corners of edges and faces, ascending, in the order of the functions.
inline constexpr std::array<std::array<int, 2>, 6> kRisingEdges = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
inline constexpr std::array<std::array<int, 3>, 4> kRisingFaces = {{{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};

constexpr int surplus_per_face(int order) { return order - 1; }
constexpr int surplus_inside(int order) { return (order - 1) * (order - 2) / 2; }
constexpr int surplus_per_element(int order) { return (order + 2) * (order + 3) / 2; }  // 6, 10, 15, 21

// The surplus_per_element values at a point: those of the six edges, then of each face, then the inner ones. 1 <= order
// <= mesh::kMaxOrder.
Eigen::VectorXd surplus_shape(int order, const Eigen::Vector4d& barycentric);

// The derivatives of surplus_shape() by (l1, l2, l3), one row per function.
mesh::ReferenceGradient surplus_gradient(int order, const Eigen::Vector4d& barycentric);

// The numbers of the functions of degree p + 1 over a whole mesh of order p.
struct SurplusSpace {
  // E x n numbers of nodes, as if each element named its corners in ascending order of their numbers. Neighbours then
  // agree on the direction of their edges and faces, and no function needs a sign. Every second element turns inside
  // out by that.
  mesh::Indices nodes;
  // E x w numbers of functions, in the order of surplus_shape(). The functions of all edges have the lowest numbers,
  // then those of faces, then the inner ones; functions of one face or element have consecutive numbers.
  mesh::Indices functions;
  // The first function of each edge, face and element; the last entry is the count of all functions.
  std::vector<int> parts;

  [[nodiscard]] int count() const { return parts.back(); }
};

SurplusSpace surplus_space(const mesh::TetMesh& mesh);  // O(E log E)

// The matrices of the functions of degree p + 1 in one element of order p.
//
// V are the element's shape functions of order p, n of them, W the w functions of degree p + 1. Displacements are
// ordered by component: row i w + a (or i n + a) is function a along axis i.
struct SurplusMatrices {
  Eigen::MatrixXd coupling;  // 3w x 3n: K between W and V
  Eigen::MatrixXd mass;      // w x n: M between W and V, equal along every axis
  Eigen::MatrixXf energy;    // 3w x 3w: energy of W when the element may relax (error_estimate.cpp)
};

class SurplusElement {
 public:
  explicit SurplusElement(int order);

  // `nodes` in the order of SurplusSpace::nodes; the element may be inside out.
  [[nodiscard]] SurplusMatrices operator()(const mesh::ElementNodes& nodes, const Law& law) const;

  [[nodiscard]] int functions() const { return w_; }
  [[nodiscard]] int nodes() const { return n_; }

 private:
  // Returns the integrals of d_k N_a d_l N_b over all functions, W's first, at row k (w + n) + a, column l (w + n) + b.
  // Also fills `mass`, without the density.
  Eigen::MatrixXd gradient_products(const mesh::ElementNodes& nodes, Eigen::MatrixXd& mass) const;
  [[nodiscard]] Eigen::MatrixXf relaxed(const Eigen::MatrixXd& products, const mesh::ElementNodes& nodes,
                                        const Law& law) const;

  int w_, n_;
  Eigen::VectorXd weights_;                         // quadrature weights, which add up to 1/6
  std::vector<mesh::ReferenceGradient> gradients_;  // w + n rows for each point
  Eigen::MatrixXd surplus_, shapes_;                // w and n rows, one column per point
  Eigen::MatrixXd straight_products_;               // gradient_products() of the reference element
  Eigen::MatrixXd straight_mass_;
};

}  // namespace ringdown::fem
