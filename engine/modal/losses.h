// The losses of a mode: to its material, to the air that it moves, and to the supports of the body. [any]
//
// A material says what it loses in one of two ways, and its modes decay accordingly:
//
//   loss factors at several frequencies   material: eta(f) omega / 2, at the mode's own undamped frequency
//   Rayleigh's alpha and beta             material: beta lambda / 2; air and support together: alpha / 2
//
// Between two frequencies of a list log eta is linear in log f; beyond its ends eta stays what it is there. Alpha is
// what air and support take of a body whose radiation nobody has computed. Where it has been, the air takes what was
// computed, and the support takes what of alpha / 2 that leaves, at least 0. A list leaves nothing to the support.
#pragma once

#include "engine/modal/damping.h"

#include <cstddef>
#include <span>

namespace ringdown::modal {

inline constexpr std::size_t kMaxLossFactors = 64;  // of a material

// Amplitude decay rates [1/s], each at least 0.
struct ModeLoss {
  double material_per_s = 0, air_per_s = 0, support_per_s = 0;
  [[nodiscard]] double total_per_s() const { return material_per_s + support_per_s + air_per_s; }
};

// How a material damps. With loss_factors, `rayleigh` is only their fit (fit_rayleigh()).
struct MaterialDamping {
  RayleighDamping rayleigh;
  std::span<const LossFactor> loss_factors;  // by frequency, ascending; empty: Rayleigh's two numbers are the material
};

// eta of a list, which is not empty and ascends in frequency, at one frequency.
double loss_factor_at(std::span<const LossFactor> list, double frequency_hz);

// The losses of the mode with eigenvalue `lambda`, of which `air_per_s` go to the air.
ModeLoss mode_loss(const MaterialDamping& damping, double lambda, double air_per_s = 0);

// The mode as heard.
DampedMode with_decay(double lambda, double decay_per_s);

// The largest lambda whose mode may still lie below band_high_hz. For a list it is exact where eta^2 (1 + slope of
// log eta) stays below 4; the steeper ones may have more modes in the band, all of them over-damped or nearly so.
double highest_lambda(double band_high_hz, const MaterialDamping& damping);

// The largest |fitted eta / eta - 1| of Rayleigh's fit between two frequencies: at the list's own and at 20 others,
// equally spaced in pitch.
double worst_error(const MaterialDamping& damping, double low_hz, double high_hz);

}  // namespace ringdown::modal
