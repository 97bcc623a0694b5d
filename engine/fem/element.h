// Stiffness and mass of one tetrahedron. [any thread]
//
// With displacement u(x) = sum_a N_a(x) u_a and g_a = grad N_a, the 3 x 3 block of nodes a and b is
//
//   K_ab = integral of  lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I        [N/m]
//   M_ab = I * integral of  rho N_a N_b                                           [kg]
//
// K_ab is B_a^T D B_b written without the zeros of B and D (Bathe, Finite Element Procedures, section 4.2). For 4 nodes
// g is constant, so K_ab is its integrand times the volume: vol (lambda b_ia b_jb + ...), without the factor -1/2 that
// the course report has (docs/how/physics.md, section 8). The mass is a multiple of I, so only the factor is kept.
//
// An anisotropic solid has K_ab(i, j) = sum over k, l of C(ik, jl) integral of g_a,k g_b,l (solid.h).
//
// All of K_ab follows from G_ab = integral of g_a g_b^T. In a straight element of any order g_a = A ghat_a with one
// matrix A = dl/dx, so G_ab = vol A Ghat_ab A^T where the numbers Ghat_ab are computed once, for the reference element.
//
// Order of unknowns in a stiffness: node by node, x y z: row 3 a + component.
#pragma once

#include "engine/fem/solid.h"
#include "engine/mesh/tet_element.h"

#include <Eigen/Core>

namespace ringdown::fem {

// Integrates elements of one order with n nodes each. It holds working memory, so each thread needs its own.
class ElementIntegrals {
 public:
  explicit ElementIntegrals(int order);

  // Fills 3n x 3n stiffness and n x n mass of a positively oriented element that does not fold (mesh::check_mesh).
  // Straight elements are integrated exactly. In curved ones the integrand of the stiffness is a rational function, and
  // the rule is exact for degree 2p + 1, two more than the eigenvalues need to keep their order of convergence
  // (Banerjee & Osborn, Numer. Math. 56, 1990); rigid motions still cost no energy, because they are in the span of the
  // N_a. The mass is exact: N_a N_b det J has degree 5p - 3.
  void operator()(const mesh::ElementNodes& nodes, const Law& law, Eigen::Ref<Eigen::MatrixXd> stiffness,
                  Eigen::Ref<Eigen::MatrixXd> mass);

 private:
  void integrate_curved(const mesh::ElementNodes& nodes, double density_kg_m3, Eigen::Ref<Eigen::MatrixXd> mass);

  int order_;
  Eigen::MatrixXd gradients_;  // G, 3n x 3n; lower triangle only
  Eigen::MatrixXd samples_;    // gradients or shape functions, one column per point
  Eigen::MatrixXd jacobians_;  // Jacobians, 3 rows per point
};

// Stiffness and consistent mass of a single element.
Eigen::MatrixXd stiffness(const mesh::ElementNodes& nodes, const Elastic& elastic);
Eigen::MatrixXd consistent_mass(const mesh::ElementNodes& nodes, double density_kg_m3);

// The lumped mass of an element of 4 nodes: a quarter of its mass at each corner, as in the course report.
Eigen::Matrix4d lumped_mass(const mesh::Corners& corners, double density_kg_m3);

}  // namespace ringdown::fem
