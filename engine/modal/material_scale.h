// A different material and size for the same modes, exactly and without a new analysis.
//
// Scaling stiffness scales every eigenvalue; density and size scale eigenvalues and mass-normalised shapes; Rayleigh's
// two terms scale on their own (docs/how/physics.md, "Another material"). Only Poisson's ratio needs a new bake.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <cmath>

namespace ringdown::modal {

// Factors on a bank's own material and on its lengths; all 1 is the bank as baked. Each is > 0, alpha and beta may be
// 0.
struct MaterialScale {
  double alpha = 1, beta = 1, density = 1, stiffness = 1;
  double size = 1;  // points of the resized object lie `size` times as far from its frame's origin
  friend bool operator==(const MaterialScale&, const MaterialScale&) = default;
};

// The factor by which undamped eigenvalues lambda are multiplied.
inline double lambda_factor(const MaterialScale& scale) {
  return scale.stiffness / (scale.density * scale.size * scale.size);
}

// The factor by which mass-normalised shapes are multiplied.
inline double shape_factor(const MaterialScale& scale) {
  return 1 / std::sqrt(scale.density * scale.size * scale.size * scale.size);
}

// Mode `m` of the bank under a scaled material; frequency_hz is 0 when it has become over-damped. The bank's decay is
// split into beta lambda / 2 (beta from its material, 0 without one) and the rest, which scales like alpha.
inline DampedMode rescale(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  const DampedMode baked{bank.frequency_hz[m], bank.decay_per_s[m]};
  if (scale == MaterialScale{}) return baked;
  const double lambda = undamped_lambda(baked);
  const double beta = bank.material ? bank.material->damping.beta_s : 0.0;
  const double stiffness_part = std::min(0.5 * beta * lambda, baked.decay_per_s);
  const double mass_part = baked.decay_per_s - stiffness_part;
  const double factor = lambda_factor(scale);
  const double decay = scale.alpha * mass_part + scale.beta * factor * stiffness_part;
  const double omega_squared = factor * lambda - decay * decay;
  return {omega_squared > 0 ? rad_per_s_to_hz(std::sqrt(omega_squared)) : 0.0, decay};
}

// Mass, centre and inertia of the scaled body.
inline MassProperties rescale(const MassProperties& mass, const MaterialScale& scale) {
  const double area = scale.size * scale.size, factor = scale.density * scale.size * area;
  MassProperties scaled = mass;
  scaled.mass_kg = factor * mass.mass_kg;
  scaled.center_of_mass_m = scale.size * mass.center_of_mass_m;
  scaled.inertia_kg_m2 = (factor * area) * mass.inertia_kg_m2;
  return scaled;
}

// A sample point of the scaled body.
inline Vec3f rescale(const Vec3f& point, const MaterialScale& scale) {
  const auto times = [&](float x) { return static_cast<float>(scale.size * static_cast<double>(x)); };
  return {times(point[0]), times(point[1]), times(point[2])};
}

}  // namespace ringdown::modal
