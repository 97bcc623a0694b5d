#include "engine/liquid/wet_modes.h"

#include "engine/dense/decompositions.h"

namespace ringdown::liquid {

Result<WetModes> wet_modes_of(const Coupled& coupled) {
  const Eigen::Index n = coupled.mass.rows(), j = coupled.own_lambda.size();
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n + j, n + j), mass = stiffness;
  stiffness.topLeftCorner(n, n) = coupled.stiffness;
  stiffness.bottomRightCorner(j, j) = coupled.own_lambda.asDiagonal();
  mass.topLeftCorner(n, n) = coupled.mass;
  mass.topRightCorner(n, j) = coupled.bond;
  mass.bottomLeftCorner(j, n) = coupled.bond.transpose();
  mass.bottomRightCorner(j, j).setIdentity();
  const auto spectrum = dense::generalized_spectrum(stiffness, mass);
  if (!spectrum)
    return fail(ErrorKind::bad_input,
                "the mass of the liquid is less than that of its own modes: its wall is distorted");
  return WetModes{spectrum->values, spectrum->vectors.topRows(n), spectrum->vectors.bottomRows(j)};
}

}  // namespace ringdown::liquid
