// An isotropic, linear elastic solid. [any thread]
#pragma once

#include "engine/base/result.h"

namespace ringdown::fem {

struct Elastic {
  double youngs_modulus_pa = 0;  // E > 0
  double poisson_ratio = 0;      // nu in (-1, 1/2)
  double density_kg_m3 = 0;      // rho > 0

  // Lame's constants: stress = lambda tr(strain) I + 2 mu strain.
  [[nodiscard]] double lambda_pa() const {
    return youngs_modulus_pa * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  }
  [[nodiscard]] double mu_pa() const { return youngs_modulus_pa / (2 * (1 + poisson_ratio)); }
};

// Fails with one sentence when a constant is outside the range in which a solid is stable.
inline Result<void> check_elastic(const Elastic& elastic) {
  if (!(elastic.youngs_modulus_pa > 0 && elastic.youngs_modulus_pa < 1e15)) {
    return fail(ErrorKind::bad_input, "Young's modulus must be a positive number of pascals");
  }
  if (!(elastic.poisson_ratio > -1 && elastic.poisson_ratio < 0.5)) {
    return fail(ErrorKind::bad_input, "Poisson's ratio must lie between -1 and 0.5, both excluded");
  }
  if (!(elastic.density_kg_m3 > 0 && elastic.density_kg_m3 < 1e6)) {
    return fail(ErrorKind::bad_input, "the density must be a positive number of kg/m^3");
  }
  return {};
}

}  // namespace ringdown::fem
