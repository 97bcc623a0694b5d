// Stiffness and mass of one tetrahedron. [any thread]
//
// With displacement u(x) = sum_a N_a(x) u_a and g_a = grad N_a, the 3 x 3 block of nodes a and b is
//
//   K_ab = integral of  lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I        [N/m]
//   M_ab = I * integral of  rho N_a N_b                                           [kg]
//
// K_ab is B_a^T D B_b written without the zeros of B and D (Bathe, Finite Element Procedures, section 4.2).
// For 4 nodes g is constant, so K_ab is its integrand times the volume: DESIGN's +vol (lambda b_ia b_jb +
// ...), without the factor -1/2 that the course report has (docs/physics.md, errata). The mass is a multiple
// of I, so only the number is kept.
//
// Order of unknowns in a stiffness: node by node, x y z: row 3 a + component.
#pragma once

#include "engine/fem/elastic.h"
#include "engine/mesh/tet_shape.h"

#include <Eigen/Core>

namespace ringdown::fem {

using Stiffness4 = Eigen::Matrix<double, 12, 12>;
using Stiffness10 = Eigen::Matrix<double, 30, 30>;
using Mass4 = Eigen::Matrix<double, 4, 4>;
using Mass10 = Eigen::Matrix<double, 10, 10>;

Stiffness4 stiffness4(const mesh::Corners& corners, const Elastic& elastic);

// rho volume / 20 (1 + delta_ab), exact.
Mass4 consistent_mass4(const mesh::Corners& corners, double density_kg_m3);

// A quarter of the element's mass at each corner, as the course report has it.
Mass4 lumped_mass4(const mesh::Corners& corners, double density_kg_m3);

// Exact for straight elements (the integrand has degree 2). In curved ones it is a rational function: the
// rule is exact for degree 5, and rigid motions still cost no energy, because they are in the span of the
// N_a.
Stiffness10 stiffness10(const mesh::Nodes10& nodes, const Elastic& elastic);

// Exact, also for curved elements: N_a N_b det J has degree 4 + 3 = 7.
Mass10 consistent_mass10(const mesh::Nodes10& nodes, double density_kg_m3);

} // namespace ringdown::fem
