// A piece of a cut body as a mesh of its own, and fields of the body, or of a coarser piece, restricted to it. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "engine/shatter/cut.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace ringdown::shatter {

struct PieceMesh {
  mesh::TetMesh mesh;                // of the body's order; n nodes
  std::vector<std::int32_t> parent;  // for each node, one of the body's elements that it lies in
  mesh::Barycentric barycentric;     // n x 4, its coordinates in that element
  std::vector<SubElement> parts;     // for each element of the mesh, the part of the body's element that it is
};

// Makes a mesh of some parts of the body, numbers in CutBody::elements, which should be joined by faces. Neighbours in
// the piece share all nodes of their face. Where parts touch in a point or an edge only, each side gets nodes of its
// own, because the crack goes through there (an edge is divided for this in all parts around it). The mesh fills
// exactly the space of the parts. `body` is the mesh that was cut. O(n log n) for n nodes, 1 us each.
PieceMesh piece_mesh(const CutBody& cut, const mesh::TetMesh& body, const std::vector<std::int64_t>& elements);

// Restricts fields on the body, 3N x m with the component i of node k in row 3 k + i, to the piece's nodes, 3n x m. The
// piece's elements then have the body's fields exactly. O(n m).
Eigen::MatrixXd restricted(const PieceMesh& piece, const mesh::TetMesh& body, const Eigen::MatrixXd& shapes);

// Restricts fields on a coarser piece of the same cut, 3N x m, to a piece that is a part of it, 3n x m. The fields are
// exact, except in elements that were divided in the coarser piece only (piece_mesh()). O(n m).
Eigen::MatrixXd restricted(const PieceMesh& piece, const PieceMesh& coarser, const Eigen::MatrixXd& shapes);

}  // namespace ringdown::shatter
