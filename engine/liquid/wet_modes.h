// The modes of a body and its liquid together, from those of either alone. [worker]
//
// The body's own modes, rigid motions included, have eigenvalues lambda and unit mass; M_a is the mass of the liquid
// that does not give way, in this basis. The liquid gives way in modes of its own (water_modes.h), each of which is one
// more oscillator of eigenvalue (c kappa)^2, bound to the body by s_j = sqrt(rho) c_j / kappa_j, c_ij the integral of
// psi_j q_i over the wall:
//
//   | Lambda       |          | I + M_a   S |
//   |     c^2 k^2  | x = l    | S^T       I | x
//
// which is exact: what the liquid's left out modes add at rest is in M_a. In a full closed cavity the liquid's constant
// mode is a spring, rho c^2 / V times the square of the volume that the wall displaces; it goes into Lambda.
#pragma once

#include "engine/base/result.h"

#include <Eigen/Core>

namespace ringdown::liquid {

struct Coupled {
  Eigen::MatrixXd stiffness;   // N x N: Lambda, and the springs of closed cavities
  Eigen::MatrixXd mass;        // N x N: I + M_a
  Eigen::MatrixXd bond;        // N x J: S
  Eigen::VectorXd own_lambda;  // J
};

struct WetModes {
  Eigen::VectorXd lambda;  // ascending; rigid motions first, about 0
  Eigen::MatrixXd body;    // N x K: amplitudes of the body's modes
  Eigen::MatrixXd liquid;  // J x K: amplitudes of the liquid's
};

// Fails when the mass is not positive, which says that the liquid's modes and its mass do not belong together.
Result<WetModes> wet_modes_of(const Coupled& coupled);

}  // namespace ringdown::liquid
