// Von Karman's free plate by polynomials: an oracle for nonlinear_modes.h that shares no code with it.
#pragma once

#include "engine/fem/elastic.h"

#include <Eigen/Core>

namespace ringdown::test {

struct PlateTerms {
  Eigen::VectorXd lambda;  // M
  Eigen::MatrixXd pairs;   // fields of all pairs i >= j, condensed: a column each, inner products are energies

  [[nodiscard]] Eigen::VectorXd field(Eigen::Index i, Eigen::Index j) const {
    return pairs.col(i < j ? j * (j + 1) / 2 + i : i * (i + 1) / 2 + j);
  }
  // The mean over a family's unit sphere of (sum over k of t_k^2) / lambda^2, as bake::own_hardening() has it.
  [[nodiscard]] Eigen::VectorXd own_hardening(double family = 2e-3) const;
};

PlateTerms von_karman_square(double side, double thickness, const fem::Elastic& elastic, int modes, int degree = 12,
                             int membrane_degree = 14);
PlateTerms von_karman_disc(double radius, double thickness, const fem::Elastic& elastic, int modes, int degree = 14,
                           int membrane_degree = 18);

}  // namespace ringdown::test
