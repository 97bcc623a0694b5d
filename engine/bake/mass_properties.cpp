#include "engine/bake/mass_properties.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace ringdown::bake {
namespace {

// Columns: the principal axes, each with its largest component positive, the last chosen to make the frame
// right-handed.
Eigen::Matrix3d principal_frame(const Eigen::Matrix3d& axes) {
  Eigen::Matrix3d frame = axes;
  for (int k = 0; k < 2; ++k) {
    Eigen::Index largest = 0;
    frame.col(k).cwiseAbs().maxCoeff(&largest);
    if (frame(largest, k) < 0) frame.col(k) *= -1;
  }
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

modal::MassProperties mass_properties(const mesh::TetMesh& mesh, const fem::SparseMatrix& node_mass) {
  const Eigen::VectorXd weight = node_mass * Eigen::VectorXd::Ones(node_mass.cols());
  const double mass = weight.sum();
  const Eigen::RowVector3d center = weight.transpose() * mesh.nodes / mass;
  const Eigen::MatrixXd arm = mesh.nodes.rowwise() - center;
  const Eigen::Matrix3d second = arm.transpose() * (node_mass * arm);
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(inertia);
  const Eigen::Vector3d& moments = principal.eigenvalues();
  const Eigen::Quaterniond turn(principal_frame(principal.eigenvectors()));
  return {.mass_kg = mass,
          .center_of_mass_m = {center[0], center[1], center[2]},
          .inertia_kg_m2 = {moments[0], moments[1], moments[2]},
          .orientation = {turn.x(), turn.y(), turn.z(), turn.w()}};
}

}  // namespace ringdown::bake
