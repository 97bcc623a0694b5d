// Stiffness and mass matrices of a whole mesh. [worker]
//
// The eigenproblem of a free elastic body is  K phi = lambda M phi  with 3 N unknowns, N the number of nodes:
// unknown 3 n + i is the displacement of node n along axis i. Because every mass is the same in all
// directions, M is kron(node_mass, I3), and only the N x N node matrix is kept.
#pragma once

#include "engine/base/result.h"
#include "engine/fem/element_kind.h"
#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/SparseCore>

namespace ringdown::fem {

using SparseMatrix = Eigen::SparseMatrix<double>;

struct System {
  SparseMatrix stiffness;  // 3N x 3N [N/m]; the LOWER triangle only, columns sorted
  SparseMatrix node_mass;  // N x N [kg]; both triangles; diagonal only when lumped

  [[nodiscard]] Eigen::Index unknowns() const { return stiffness.rows(); }
};

// Assembles both matrices. The mesh must have the element's order (mesh::to_order) and be checked (mesh::check_mesh).
// threads = 0 uses one thread per processor. Each entry is summed by one thread, in the order of the elements, so the
// result is the same to the last bit in every run and for any number of threads. O(E), without a list of triplets: the
// pattern is found first, from the nodes' neighbours. Fails on an unstable material and when memory runs out.
Result<System> assemble(const mesh::TetMesh& mesh, const Solid& solid, Element element, int threads = 0);

// y = kron(node_mass, I3) x, for 3N numbers or a 3N x m matrix. y must not be x.
void apply_mass(const SparseMatrix& node_mass, const double* x, double* y);
Eigen::MatrixXd mass_times(const SparseMatrix& node_mass, const Eigen::MatrixXd& x);

}  // namespace ringdown::fem
