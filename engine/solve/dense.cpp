#include "engine/solve/methods.h"

#include <Eigen/Eigenvalues>

namespace ringdown::solve {

Result<Eigenmodes> solve_dense(const fem::System& system) {
  const Eigen::MatrixXd stiffness = Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd mass =
      fem::mass_times(system.node_mass, Eigen::MatrixXd::Identity(stiffness.rows(), stiffness.rows()));
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solved(stiffness, mass);
  if (solved.info() != Eigen::Success) {
    return fail(ErrorKind::bad_input, "the mass of the mesh is not positive; check the mesh for flat elements");
  }
  Eigenmodes modes;
  modes.lambda = solved.eigenvalues();
  modes.shapes = solved.eigenvectors();
  return modes;
}

}  // namespace ringdown::solve
