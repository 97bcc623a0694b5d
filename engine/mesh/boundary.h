// The skin of a solid. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::mesh {

// Triangles between nodes of a TetMesh.
struct Boundary {
  std::vector<std::int32_t> nodes;                      // P numbers of nodes in the TetMesh, ascending
  std::vector<std::array<std::uint32_t, 3>> triangles;  // positions in `nodes`, counter-clockwise from outside
};

// A face that belongs to one element only.
struct OuterFace {
  std::array<std::int32_t, 3> corners;  // numbers of nodes, ascending
  Eigen::Index element;
  int opposite;  // the corner of the element that the face lies opposite to: kTetFaces turns it outward
};
std::vector<OuterFace> outer_faces(const Indices& elements);  // ordered by their corners

// The faces that belong to one element only, turned outward. A face of an element of order p becomes p^2 flat triangles
// between all its nodes, so that a coarse mesh of high order has as many points as its shapes need.
Boundary boundary_of(const TetMesh& mesh);

// Points on the curved faces of the elements, one or three for each triangle of boundary_of(), in the order of the
// triangles.
struct SurfaceQuadrature {
  // N x P: values at the points from those at the surface's nodes, by the elements' shape functions.
  Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation;
  Points normals;         // N x 3, outward, of length 1
  Eigen::VectorXd areas;  // N [m^2], that the points stand for
};
SurfaceQuadrature quadrature_of(const Boundary& surface, const TetMesh& mesh, int points_per_triangle);

// Points on the curved faces, at which sums are the integrals of what the elements' shape functions push through the
// faces: exactly what flows through each face, so that nothing is left over where flow to and fro cancels. About three
// points for each triangle of boundary_of(); of those of one face, which stand together, the sum counts.
SurfaceQuadrature flow_quadrature_of(const Boundary& surface, const TetMesh& mesh);

// P weights that sum to 1: a third of the area of the triangles around each point, over the whole area.
std::vector<double> area_weights(const Boundary& surface, const Points& nodes);

// The skin of a body as a surface of its own, turned outward.
TriangleMesh skin_of(const TetMesh& mesh);

}  // namespace ringdown::mesh
