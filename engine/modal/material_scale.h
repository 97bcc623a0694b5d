// A different material and size for the same modes, exactly and without a new analysis.
//
// Scaling stiffness scales every eigenvalue; density and size scale eigenvalues and mass-normalised shapes; what modes
// lose to material, air and support scales in parts (docs/how/physics.md, "Another material"). Only Poisson's ratio
// needs a new bake.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/damping.h"
#include "engine/modal/losses.h"

#include <cmath>
#include <cstddef>

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

// The losses of mode `m` of the bank as baked. If the bank does not state them, its decay is split into beta lambda / 2
// (beta from its material, 0 without one) for the material and the rest for the support.
ModeLoss loss_of(const Bank& bank, std::size_t m);

// The losses of mode `m` under a scaled material. `alpha` scales what air and support took by the material's alpha, of
// which the air then takes its part; `beta` scales the material's part. Where the material is a list of loss factors,
// that part follows the list to the new frequency, and `alpha` and `beta` scale the shares of it that Rayleigh's fit
// has at that frequency.
ModeLoss rescaled_loss(const Bank& bank, std::size_t m, const MaterialScale& scale);

// The loss of mode `m` to the air under a scaled material. The effect of a change of size is exact: a mode radiates the
// same share of its energy in a cycle. Stiffness and density move its pitch against its size, and with it how well it
// radiates, as far as the bank's radiation knows (level_ratio()); without radiation that share is kept, too.
double rescaled_air_loss(const Bank& bank, std::size_t m, const MaterialScale& scale);

// Mode `m` of the bank under a scaled material; frequency_hz is 0 when it has become over-damped.
DampedMode rescale(const Bank& bank, std::size_t m, const MaterialScale& scale);

// The far field of a mode of the scaled body. Its size changes it exactly; stiffness and density by its levels, all
// directions alike.
FarField rescale(const FarField& field, const MaterialScale& scale);

// Mass, centre and inertia of the scaled body.
inline MassProperties rescale(const MassProperties& mass, const MaterialScale& scale) {
  const double area = scale.size * scale.size, factor = scale.density * scale.size * area;
  MassProperties scaled = mass;
  scaled.mass_kg = factor * mass.mass_kg;
  scaled.center_of_mass_m = scale.size * mass.center_of_mass_m;
  scaled.inertia_kg_m2 = (factor * area) * mass.inertia_kg_m2;
  return scaled;
}

// The nonlinear terms of the scaled body, exact by dimensions.
inline void rescale(NonlinearTerms& terms, const MaterialScale& scale) {
  const double root = std::sqrt(scale.stiffness);
  multiply(terms, root / (scale.density * std::pow(scale.size, 3.5)), root / (std::sqrt(scale.density) * scale.size));
  terms.thickness_m *= scale.size;
}

// A sample point of the scaled body.
inline Vec3f rescale(const Vec3f& point, const MaterialScale& scale) {
  const auto times = [&](float x) { return static_cast<float>(scale.size * static_cast<double>(x)); };
  return {times(point[0]), times(point[1]), times(point[2])};
}

}  // namespace ringdown::modal
