// Thermoelastic loss: heat that flows in a vibrating body while it is bent. [worker]
//
// A mode of small amplitude u presses and stretches the body, and warms it by -T0 E alpha / (1 - 2 nu) div u / (rho c).
// The temperature theta obeys (k K + i omega rho c C) theta = -i omega T0 B u, with natural (insulated) surfaces, and
//
//   K_ab = integral of grad N_a . grad N_b,   C_ab = integral of N_a N_b,   (B u)_a = integral of N_a beta : grad u
//
// with thermal stress beta = C : I, the stress per relative expansion (Biot, J. Appl. Phys. 27, 1956). Its lag gives
// the loss factor. Seen from b = B u, the pencil (K, C) has real relaxation modes, so that the loss factor is
//
//   eta(omega) = sum over j of s_j omega tau_j / (1 + (omega tau_j)^2),       tau_j = 1 / rate_j.
//
// A few steps of Lanczos with (K + s C)^-1 C from C^-1 b give the Gauss rule of this sum: kHeatPairs pairs that match
// its moments, and so hold at every frequency, material and size (Golub & Meurant, Matrices, Moments and Quadrature,
// 2010). Frequencies do not enter at all.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/fem/solid.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

namespace ringdown::fem {

inline constexpr int kHeatPairs = 4;

// Thermal constants of a part of the body, as ratios to one reference material. Conductivity and capacity (per
// volume) > 0.
struct HeatRatios {
  double expansion = 1, conductivity = 1, capacity = 1;
};

struct HeatSource {
  const mesh::TetMesh& mesh;                 // free of units, as all lengths here; of order 2 at least
  const Solid& solid;                        // stiffness in units of one modulus
  const std::vector<HeatRatios>& parts;      // one at least
  const std::vector<std::int32_t>& part_of;  // E; empty: one part
  double wall = 0;                           // the typical thickness
};

// Temperatures on the nodes of a mesh, and the two matrices of the heat equation.
class HeatProblem {
 public:
  // Temperature is cubic in each element, or of the element's own order where that is higher: in one element across a
  // bent wall that leaves 1 % of the loss up to omega tau = 20.
  HeatProblem(const HeatSource& source, int threads = 0);

  [[nodiscard]] const mesh::TetMesh& mesh() const { return heat_mesh_; }  // of the temperature
  [[nodiscard]] const Eigen::SparseMatrix<double, Eigen::RowMajor>& conduction() const { return conduction_; }
  [[nodiscard]] const Eigen::SparseMatrix<double, Eigen::RowMajor>& capacity() const { return capacity_; }

  // b for shapes at the nodes of the source's mesh, 3N x m: one column for each.
  [[nodiscard]] Eigen::MatrixXd warmth(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const;

 private:
  const HeatSource source_;
  int threads_;
  mesh::TetMesh heat_mesh_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> conduction_, capacity_;
};

// Pairs (s_j, rate_j) of each of m modes, one below the other: 2 kHeatPairs x m. `shapes` are 3N x m and of any norm;
// `lambda` are their phi^T K phi, > 0. Progress stage "heat". Fails when cancelled or when an iteration does not
// converge. O(N m).
Result<Eigen::MatrixXd> heat_relaxations(const HeatSource& source, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                         const Eigen::VectorXd& lambda, const Progress& progress = {}, int threads = 0);

}  // namespace ringdown::fem
