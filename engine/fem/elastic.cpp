#include "engine/fem/elastic.h"

namespace ringdown::fem {

Result<void> check_elastic(const Elastic& elastic) {
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
