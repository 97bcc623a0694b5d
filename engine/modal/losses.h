// The losses of a mode: to its material, to the air that it moves, and to the supports of the body. [any]
//
// A material's damping is described in one of two ways, and its modes decay accordingly:
//
//   loss factors at several frequencies   material: eta(f) omega / 2, at the mode's own undamped frequency
//   Rayleigh's alpha and beta             material: beta lambda / 2; air and support together: alpha / 2
//
// Between two frequencies of a list, log eta is linear in log f; beyond the ends of the list eta is constant. Alpha
// stands for the losses to air and support together. If the body's radiation was computed, the air takes the computed
// loss, and the support takes the rest of alpha / 2, at least 0. A material with a list has no loss to the support.
#pragma once

#include "engine/modal/damping.h"

#include <cstddef>
#include <span>

namespace ringdown::modal {

inline constexpr std::size_t kMaxLossFactors = 64;  // for each material

// Amplitude decay rates [1/s], each at least 0.
struct ModeLoss {
  double material_per_s = 0, air_per_s = 0, support_per_s = 0;
  [[nodiscard]] double total_per_s() const { return material_per_s + support_per_s + air_per_s; }
};

// The damping of a material. With loss_factors, `rayleigh` is only their fit (fit_rayleigh()).
struct MaterialDamping {
  RayleighDamping rayleigh;
  std::span<const LossFactor> loss_factors;  // by ascending frequency; empty: Rayleigh's two numbers decide
};

// Returns eta at one frequency by a list that is not empty and ascends in frequency.
double loss_factor_at(std::span<const LossFactor> list, double frequency_hz);

// Returns the losses of the mode with eigenvalue `lambda` and the loss `air_per_s` to the air.
ModeLoss mode_loss(const MaterialDamping& damping, double lambda, double air_per_s = 0);

// Returns the damped mode of eigenvalue `lambda` [rad^2/s^2] and this decay.
DampedMode with_decay(double lambda, double decay_per_s);

// Returns the largest lambda whose mode may still lie below band_high_hz. For a list the result is exact where
// eta^2 (1 + slope of log eta) stays below 4; with a steeper list more modes may lie in the band, all of them
// over-damped or nearly so.
double highest_lambda(double band_high_hz, const MaterialDamping& damping);

// Returns the largest |fitted eta / eta - 1| of Rayleigh's fit between two frequencies, taken at the list's own
// frequencies and at 20 more, equally spaced in pitch.
double worst_error(const MaterialDamping& damping, double low_hz, double high_hz);

}  // namespace ringdown::modal
