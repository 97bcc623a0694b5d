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

// One sentence when a constant is outside the range in which a solid is stable.
Result<void> check_elastic(const Elastic& elastic);

}  // namespace ringdown::fem
