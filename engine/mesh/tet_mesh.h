// A solid as tetrahedra. [worker]
//
// Nodes are points in metres. All elements of a mesh have the same order p, 1 to 4, and 4, 10, 20 or 35 nodes in the
// order of tet_basis.h: inside, displacement and position are polynomials of degree p, so above order 1 edges and faces
// may be curved. Corners 1, 2, 3 turn counter-clockwise when seen from outside opposite corner 0, so that
//   det[x1-x0, x2-x0, x3-x0] > 0.
// gmsh's order of nodes is another one; gmsh_reader.cpp changes it.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_shape.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace ringdown::mesh {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Indices = Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct TetMesh {
  Points nodes;      // N x 3 [m]
  Indices elements;  // E x 4, 10, 20 or 35, numbers of nodes

  [[nodiscard]] int order() const { return order_of_nodes(elements.cols()); }
};

// The nodes of one element, in its order.
ElementNodes nodes_of(const TetMesh& mesh, Eigen::Index element);
Corners corners_of(const TetMesh& mesh, Eigen::Index element);

// A mesh that the other folders may trust: node numbers in range, every node used, every element positively
// oriented and with volume, coordinates finite, neighbours joined by whole faces (mesh_joints.h), none inside
// another (overlap.h).
struct CheckedMesh {
  TetMesh mesh;
  int pieces = 0;        // parts that share no node
  int flipped = 0;       // elements given inside out, now turned
  int straightened = 0;  // curved elements that folded over themselves, now less curved or straight
  int unused_nodes = 0;  // dropped
  int duplicates = 0;    // elements with the same nodes as another, dropped
};

// Repairs what has one right repair (the counts above) and refuses the rest: no elements, a node number out of range or
// twice in an element, a coordinate that is not finite, an element without volume, elements that overlap, parts that
// touch in an edge or a point only. A curved element folds where the determinant of its map falls below a thousandth of
// the straight one's; it is looked at in as many points as determine that polynomial, and in those that assembly
// integrates over. One that does loses half of its curvature, up to three times, then all. `name` stands in the
// sentence. O(E log E).
Result<CheckedMesh> check_mesh(TetMesh mesh, const std::string& name);

// The same elements with the nodes of another order: each element's own map at the places of the new nodes, which are
// shared by the elements around an edge or a face. Raising the order keeps the geometry exactly. Lowering it keeps the
// corners and puts the other nodes on the old curve; what the lower order cannot follow in between is lost, and
// elements that would fold lose curvature. Corners come first, in their old sequence. O(E).
TetMesh to_order(const TetMesh& mesh, int order);

// Every element cut into eight of the same order, which together are the same body: its corners cut off, and the
// octahedron between them cut in four along its shortest diagonal (Bey, Computing 55, 1995).
TetMesh split(const TetMesh& mesh);

}  // namespace ringdown::mesh
