// A solid as tetrahedra. [worker]
//
// Nodes are points in metres. An element has 4 nodes (straight edges, displacement linear inside) or 10 nodes
// (edges and faces may be curved, displacement quadratic). All elements of a mesh have the same order. Node
// order of an element: four corners, of which 1, 2, 3 turn counter-clockwise when seen from outside opposite
// corner 0, so that
//   det[x1-x0, x2-x0, x3-x0] > 0,
// then the nodes on the edges in the order of kTetEdges. That is VTK's and CalculiX's order; gmsh's has the
// last two edges exchanged (gmsh_reader.cpp exchanges them back).
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_basis.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace ringdown::mesh {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Indices = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct TetMesh {
  Points nodes;      // N x 3 [m]
  Indices elements;  // E x 4 or E x 10, numbers of nodes

  [[nodiscard]] bool quadratic() const { return elements.cols() == 10; }
};

// A mesh that the other folders may trust: node numbers in range, every node used, every element positively
// oriented and with volume, coordinates finite.
struct CheckedMesh {
  TetMesh mesh;
  int pieces = 0;        // parts that share no node
  int flipped = 0;       // elements given inside out, now turned
  int straightened = 0;  // curved elements that folded over themselves, whose edges are now straight
  int unused_nodes = 0;  // dropped
};

// Repairs what has one right repair (the counts above) and refuses the rest: no elements, a node number out
// of range, a coordinate that is not finite, an element without volume. `name` stands in the sentence. O(E
// log E).
Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name);

// 4 -> 10 nodes: a node in the middle of every edge, shared by the elements around it. Corners keep their
// numbers.
TetMesh to_quadratic(const TetMesh& mesh);

// 10 -> 4 nodes: straight edges between the corners; the nodes on edges are dropped.
TetMesh to_linear(const TetMesh& mesh);

}  // namespace ringdown::mesh
