// Extracts the skin of a solid. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/SparseCore>

#include <array>
#include <cstdint>
#include <vector>

namespace ringdown::mesh {

// A surface of triangles between nodes of a TetMesh.
struct Boundary {
  std::vector<std::int32_t> nodes;                      // P numbers of nodes in the TetMesh, ascending
  std::vector<std::array<std::uint32_t, 3>> triangles;  // positions in `nodes`, counter-clockwise from outside
};

// A face that belongs to one element only.
struct OuterFace {
  std::array<std::int32_t, 3> corners;  // numbers of nodes, ascending
  Eigen::Index element;
  int opposite;  // the element's corner opposite the face; kTetFaces[opposite] is turned outward
};
std::vector<OuterFace> outer_faces(const Indices& elements);  // ordered by their corners

// Returns the faces that belong to one element only, turned outward. A face of an element of order p becomes p^2 flat
// triangles between all its nodes, so that a coarse mesh of high order has enough points for its mode shapes.
Boundary boundary_of(const TetMesh& mesh);

// Quadrature points on the curved faces of the elements, one or three for each triangle of boundary_of(), in the order
// of the triangles.
struct SurfaceQuadrature {
  // N x P: maps values at the surface's nodes to values at the points, by the elements' shape functions.
  Eigen::SparseMatrix<double, Eigen::RowMajor> interpolation;
  Points normals;         // N x 3, outward, of length 1
  Eigen::VectorXd areas;  // N [m^2], the area that each point represents
};
SurfaceQuadrature quadrature_of(const Boundary& surface, const TetMesh& mesh, int points_per_triangle);

// Returns points on the curved faces at which a sum is the exact flow of the elements' shape functions through each
// face, so that no error is left where opposite flows cancel. There are about three points for each triangle of
// boundary_of(). The points of one face are consecutive; only the sum over a face is exact.
SurfaceQuadrature flow_quadrature_of(const Boundary& surface, const TetMesh& mesh);

// Returns P weights that sum to 1: for each point, a third of the area of the triangles around it, over the whole area.
std::vector<double> area_weights(const Boundary& surface, const Points& nodes);

// Returns the skin of a body as a separate surface, turned outward.
TriangleMesh skin_of(const TetMesh& mesh);

}  // namespace ringdown::mesh
