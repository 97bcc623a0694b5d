// A solid as tetrahedra, and its conversion to elements of another order or of half the size. [worker]
//
// Nodes are points in metres. All elements of a mesh have the same order p, 1 to 4, and 4, 10, 20 or 35 nodes in the
// order of tet_element.h: inside an element, position is a polynomial of degree p, so above order 1 edges and faces may
// be curved. Corners 1, 2, 3 turn counter-clockwise when seen from outside opposite corner 0, so that
//   det[x1-x0, x2-x0, x3-x0] > 0.
// A mesh from a file may break any of these rules; mesh_check.h checks them.
#pragma once

#include "engine/mesh/tet_element.h"

#include <Eigen/Core>

#include <cstdint>

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

// Removes the nodes that `elements` do not name and renumbers the remaining ones, which keep their order. Returns the
// number of removed nodes. O(N + E).
int drop_unused_nodes(Points& nodes, Eigen::Ref<Indices> elements);

// Converts the elements to another order. Each element's map gives the places of its new nodes, which the elements
// around an edge or a face share. Raising the order keeps the geometry exactly. Lowering the order keeps the corners
// and puts all other nodes on the old curve; detail beyond the lower order is lost, and elements that would fold lose
// curvature. Corners come first, in their old sequence. O(E).
TetMesh to_order(const TetMesh& mesh, int order);

// Cuts every element into eight of equal order, which together are the original body: the corners are cut off, and the
// octahedron between them is cut in four along its shortest diagonal (Bey, Computing 55, 1995). O(E).
TetMesh split(const TetMesh& mesh);

// Reduces the curvature of elements that fold. A curved element folds where the determinant of its map falls below a
// thousandth of the straight element's. Such an element loses half of its curvature, up to three times, then all of it.
// Returns the number of changed elements. O(E) for each of a few rounds.
int straighten_folded(TetMesh& mesh);

// The volume that the elements fill, curved as they are [m^3]. O(E).
double volume_of(const TetMesh& mesh);

struct TetQuality {
  double smallest_angle_deg = 180, largest_angle_deg = 0;  // dihedral; a regular tetrahedron's are 70.5
  double shortest_edge_m = 0, longest_edge_m = 0;
};

// Measures the shape of the straight elements between the corners. O(E).
TetQuality quality_of(const TetMesh& mesh);

}  // namespace ringdown::mesh
