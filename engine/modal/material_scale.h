// A different material and size for the same modes, exactly and without a new analysis.
//
// Scaling stiffness scales every eigenvalue. Density and size scale eigenvalues and mass-normalised shapes. The losses
// to material, heat, air and support scale separately (docs/how/physics.md, "Another material"). Only another Poisson's
// ratio needs a new bake.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/damping.h"
#include "engine/modal/losses.h"

#include <cmath>
#include <cstddef>
#include <string>

namespace ringdown::modal {

// Factors on a bank's own material and on its lengths. With all factors 1 the bank is as baked. Those on losses are >=
// 0, the other factors > 0.
struct MaterialScale {
  double alpha = 1;  // on what the supports take; of a material with Rayleigh's constants on alpha
  double beta = 1;   // on what the material takes; of a material with Rayleigh's constants on beta
  double density = 1, stiffness = 1;
  double size = 1;  // points of the resized object lie `size` times as far from its frame's origin
  double heat = 1;  // on what flows as heat
  double air = 1;   // on what the air takes; it changes how long modes ring, not how loudly they radiate
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

// Returns what the material takes of a mode, in words: "loss factor 0.0002", of a list at its ends, or Rayleigh's
// constants.
std::string describe_damping(const Material& material);

// Returns the loss of mode `m` to its material over that of its material as a whole: by a grain, parts of other
// materials, or springs that have a share of its energy. 1 to rounding where nothing of that is known.
double material_share(const Bank& bank, std::size_t m);

// Returns the losses of mode `m` of the bank as baked. If the bank does not state them, the mode's decay is split into
// beta lambda / 2 (beta from the bank's material, 0 without one) for the material and the rest for the support.
ModeLoss loss_of(const Bank& bank, std::size_t m);

// Returns the losses of mode `m` under a scaled material. If the material is a list of loss factors, each part follows
// its own law: the material's is read from the list at the new frequency, heat relaxes as in a body of the new
// size, and supports take 1 / (density size) of what they took, as if they were spread over the same share of the
// surface. With Rayleigh's constants, `alpha` scales the losses to air and support that come from the material's alpha,
// and the air takes its part of them.
ModeLoss rescaled_loss(const Bank& bank, std::size_t m, const MaterialScale& scale);

// Returns the relaxations of mode `m` of the scaled body, at `scale.heat` times their strengths; none where the bank
// has none.
ModeHeat rescaled_heat(const Bank& bank, std::size_t m, const MaterialScale& scale);

// Returns the loss of mode `m` to the air under a scaled material, before `scale.air`. A change of size is treated
// exactly: the share of its energy that a mode radiates in a cycle stays. Stiffness and density change the pitch
// relative to the size, and so the radiation efficiency; level_ratio() gives that change if the bank has radiation,
// otherwise the share stays.
double rescaled_air_loss(const Bank& bank, std::size_t m, const MaterialScale& scale);

// Returns mode `m` of the bank under a scaled material; frequency_hz is 0 if the mode has become over-damped.
DampedMode rescale(const Bank& bank, std::size_t m, const MaterialScale& scale);

// Returns the far field of a mode of the scaled body. A change of size is exact. Stiffness and density scale the far
// field by its levels, equally in all directions.
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
