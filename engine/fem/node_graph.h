// Which nodes of a mesh share an element: the pattern of its matrices. Private to engine/fem. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/SparseCore>

#include <vector>

namespace ringdown::fem {

// Node n shares an element with neighbors[first[n]] ... neighbors[first[n+1] - 1], ascending; it is among them itself,
// at own[n].
struct NodeGraph {
  std::vector<int> first, own, neighbors;

  [[nodiscard]] int node_count() const { return static_cast<int>(own.size()); }
};

NodeGraph node_graph(const mesh::TetMesh& mesh, int threads);

// Every entry of the matrices of such a mesh, with the value 0. The stiffness is the lower triangle of a matrix of 3 x
// 3 blocks: column 3n+j holds rows j..2 of the diagonal block, then three rows of each later neighbour. The mass has
// one number for each pair of neighbours, both triangles; lumped, only the diagonal.
void lay_out_stiffness(const NodeGraph& graph, int threads, Eigen::SparseMatrix<double>& stiffness);
void lay_out_mass(const NodeGraph& graph, bool lumped, Eigen::SparseMatrix<double>& mass);

}  // namespace ringdown::fem
