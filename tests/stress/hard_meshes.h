// Meshes that are hard on the solver, or wrong.
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "tests/fem/sample_meshes.h"

#include <array>
#include <vector>

namespace ringdown::test {

// The smallest angle [degree] between two faces of an element, of all (straight) elements.
double smallest_dihedral_degree(const mesh::TetMesh& mesh);

// The longest edge of an element over its smallest height, the largest of all.
double largest_aspect(const mesh::TetMesh& mesh);

// Nodes closer than a billionth of the mesh's length become one.
mesh::TetMesh welded(const mesh::TetMesh& mesh);

// A box whose halves are cut along different diagonals where they meet in the middle of z; in every square there a flat
// sliver of four nodes fills the gap, with that dihedral angle at four of its edges. cells.x odd, cells.z even.
mesh::TetMesh box_with_slivers(Cells cells, const Eigen::Vector3d& size, double degree);

// The layer of cells in the middle of an axis made thinner, `share` of what it was; the others take what it gives up.
// An odd number of layers along the axis.
mesh::TetMesh with_thin_layer(mesh::TetMesh box, int axis, int layers, double share);

// A hollow sphere about the origin, all nodes on spheres: an icosahedron's 20 triangles, each parted into 4^level, and
// one layer of prisms of three elements.
mesh::TetMesh hollow_sphere(double inner_m, double outer_m, int level, int order);

// Cubes of a grid, each of 6 elements, that share the nodes where they touch.
mesh::TetMesh cubes(const std::vector<std::array<int, 3>>& cells, double edge_m = 0.1);

// One element with corners that have no symmetry, 0.1 m long.
mesh::TetMesh one_element(int order);

}  // namespace ringdown::test
