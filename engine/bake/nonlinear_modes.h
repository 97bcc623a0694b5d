// Geometric nonlinearity from finite elements: modes of large amplitude change each other's pitch. [worker]
//
// With q the modal displacements of M modes, Green's strain is eps(q) + E2(q, q) (fem/quadratic_strain.h). All other
// motions u follow at once and take what strain they can, so that the energy becomes
//
//   E = 1/2 q^T Omega^2 q + sum over k of [ (g_k . q) t_k + 1/2 t_k^2 ],     t_k = q^T H^k q
//
// where H^k and g_k are the products of E2 and of eps with fields of strain B_k that are orthonormal in energy and that
// no u can take away. In flat bodies they are the membrane's stress functions, and g = 0; curved bodies have g, too.
// Touze, Thomas & Chaigne, J. Sound Vib. 258, 2002, have the same equation for plates; Ducceschi & Touze, J. Sound Vib.
// 344, 2015. docs/how/nonlinear.md derives it.
//
// The B_k are found by a randomised range finder (Halko, Martinsson & Tropp, SIAM Rev. 53, 2011; Nystrom's form with
// one power iteration): random mixtures of all pairs of modes, each condensed by one solve with the factored K, instead
// of M (M + 1) / 2 of them.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/fem/assembly.h"
#include "engine/mesh/tet_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::bake {

// Free of units, as BodyModes are (body_modes.h): H goes as E^(1/2) rho^-1 L^(-7/2), g as E^(1/2) rho^(-1/2) L^-1.
struct NonlinearModes {
  Eigen::MatrixXd bending;    // K x M(M+1)/2: H^k_ij, i >= j, row after row of the lower triangle
  Eigen::MatrixXd curving;    // K x M: g
  double residual = 0;        // share of the pairs' energy, each over its two modes', that the K fields do not hold
  double membrane_share = 0;  // of linear energy that is membrane's, of the mode with the most
  double carried_share = 0;   // the largest change of a low mode's own term by what is left out, the turning of
                              // its own linear stress (fem::QuadraticStrain::carried_force): over that term, or over
                              // the mean mode's where a mode hardly stretches

  [[nodiscard]] Eigen::Index modes() const { return curving.cols(); }
  [[nodiscard]] Eigen::Index functions() const { return curving.rows(); }
  [[nodiscard]] Eigen::MatrixXd matrix(Eigen::Index k) const;  // H^k, M x M
};

inline constexpr int kMaxNonlinearModes = 300;  // modal::kMaxNonlinearModes

// Returns the number of fields B_k for M modes.
int nonlinear_functions(int modes);

// For the first M elastic modes: `shapes` (3N x (rigid + m), M-orthonormal, m >= M) begin with the rigid motions.
// `unit_mesh` and `system` are those of the shapes. Progress stage "nonlinear". Fails when the system cannot be
// factored, or when cancelled. Cost: 3 K solves, and for each of them some 30 operations for each unknown and mode.
Result<NonlinearModes> find_nonlinear(const mesh::TetMesh& unit_mesh, const fem::Elastic& elastic,
                                      const fem::System& system, const Eigen::VectorXd& lambda,
                                      const Eigen::MatrixXd& shapes, int rigid, int modes,
                                      const Progress& progress = {});

// Returns M numbers: how strongly each mode changes its own pitch. They do not depend on the basis inside a family of
// equal frequencies: each is the mean of (sum over k of t_k^2) / lambda^2 over the family's unit sphere.
Eigen::VectorXd own_hardening(const NonlinearModes& modes, const Eigen::VectorXd& lambda);

}  // namespace ringdown::bake
