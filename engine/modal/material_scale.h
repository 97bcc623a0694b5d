// A different material for the same modes, exactly and without a new analysis.
//
// Scaling stiffness scales every eigenvalue, scaling density scales eigenvalues and mass-normalised shapes, and
// Rayleigh's two terms scale on their own (docs/physics.md, "Another material"). Only Poisson's ratio needs a new bake.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>

namespace ringdown::modal {

// Factors on a bank's own material; all 1 is the bank as baked. Each is > 0, alpha and beta may be 0.
struct MaterialScale {
  double alpha = 1, beta = 1, density = 1, stiffness = 1;
  friend bool operator==(const MaterialScale&, const MaterialScale&) = default;
};

// Mode `m` of the bank under a scaled material; frequency_hz is 0 when it has become over-damped. The bank's decay is
// split into beta lambda / 2 (beta from its material, 0 without one) and the rest, which scales like alpha.
inline DampedMode rescale(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  const DampedMode baked{bank.frequency_hz[m], bank.decay_per_s[m]};
  if (scale == MaterialScale{}) return baked;
  const double lambda = undamped_lambda(baked);
  const double beta = bank.material ? bank.material->damping.beta_s : 0.0;
  const double stiffness_part = std::min(0.5 * beta * lambda, baked.decay_per_s);
  const double mass_part = baked.decay_per_s - stiffness_part;
  const double factor = scale.stiffness / scale.density;
  const double decay = scale.alpha * mass_part + scale.beta * factor * stiffness_part;
  const double omega_squared = factor * lambda - decay * decay;
  return {omega_squared > 0 ? rad_per_s_to_hz(std::sqrt(omega_squared)) : 0.0, decay};
}

// What mass-normalised shapes are multiplied by.
inline double shape_factor(const MaterialScale& scale) { return 1 / std::sqrt(scale.density); }

}  // namespace ringdown::modal
