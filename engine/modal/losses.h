// The losses of a mode: to its material, to heat that flows in it, to the air that it moves, and to the supports of the
// body. [any]
//
// A material's damping is described in one of two ways, and its modes decay accordingly:
//
//   loss factors                material: eta(f) omega / 2, at the mode's own undamped frequency
//   Rayleigh's alpha and beta   material: beta lambda / 2; air and support together: alpha / 2
//
// Between two frequencies of a list, log eta is linear in log f; beyond the ends of the list eta is constant, and so it
// is everywhere when the list has one frequency. Alpha stands for the losses to air and support together. If the body's
// radiation was computed, the air takes the computed loss, and the support takes the rest of alpha / 2, at least 0. A
// body of a material with a list loses to a support only what a support says that it takes. What flows as heat is not
// in the list (below).
#pragma once

#include "engine/modal/damping.h"

#include <array>
#include <cstddef>
#include <span>

namespace ringdown::modal {

inline constexpr std::size_t kMaxLossFactors = 64;  // for each material

// Amplitude decay rates [1/s], each at least 0.
struct ModeLoss {
  double material_per_s = 0, air_per_s = 0, support_per_s = 0, heat_per_s = 0;
  [[nodiscard]] double total_per_s() const { return material_per_s + support_per_s + air_per_s + heat_per_s; }
};

// The damping of a material. With loss_factors, `rayleigh` is only their fit (fit_rayleigh_to_list()).
struct MaterialDamping {
  RayleighDamping rayleigh;
  std::span<const LossFactor> loss_factors;  // by ascending frequency; empty: Rayleigh's two numbers decide
};

// Returns eta at one frequency by a list that is not empty and ascends in frequency.
double loss_factor_at(std::span<const LossFactor> list, double frequency_hz);

// Returns Rayleigh's constants that come nearest to a list that is not empty at the octaves from 125 Hz to 8 kHz: for
// readers that know no others.
RayleighDamping fit_rayleigh_to_list(std::span<const LossFactor> list);

// Returns the losses of the mode with eigenvalue `lambda` and the loss `air_per_s` to the air; none to heat.
ModeLoss mode_loss(const MaterialDamping& damping, double lambda, double air_per_s = 0);

// Returns the damped mode of eigenvalue `lambda` [rad^2/s^2] and this decay.
DampedMode with_decay(double lambda, double decay_per_s);

// Returns the largest lambda whose mode may still lie below band_high_hz. For a list the result is exact where
// eta^2 (1 + slope of log eta) stays below 4; with a steeper list more modes may lie in the band, all of them
// over-damped or nearly so.
double highest_lambda(double band_high_hz, const MaterialDamping& damping);

// Heat that flows in a body while it bends
//
// A bent body warms where it is pressed together and cools where it is stretched, and heat that flows between the two
// costs energy (Zener, Phys. Rev. 52, 1937). A body's heat relaxes in many ways at once; of each, the loss factor is a
// Debye peak at the angular frequency 1 / tau:
//
//   eta(omega) = sum over relaxations of  strength omega tau / (1 + (omega tau)^2)
//
// engine/fem/heat_flow.h finds the few pairs (strength, tau) that stand for all relaxations of a mode, at any
// frequency. In another size and material of the same Poisson's ratio a strength goes as Young's modulus times
// expansion squared over heat capacity per volume, and tau as length squared times heat capacity per volume over
// conductivity.

inline constexpr double kRoomTemperature_k = 293.15;
inline constexpr int kRelaxations = 4;  // for each mode

// Thermal constants of a material; each is > 0.
struct Thermal {
  double expansion_per_k = 0;      // of a length
  double conductivity_w_mk = 0;    // [W / (m K)]
  double heat_capacity_j_kgk = 0;  // at constant pressure [J / (kg K)]
  friend bool operator==(const Thermal&, const Thermal&) = default;
};

// Returns E alpha^2 T / (rho c), the relative difference between the adiabatic and the isothermal modulus at room
// temperature.
double relaxation_strength(const Thermal& thermal, double youngs_modulus_pa, double density_kg_m3);

// Returns k / (rho c) [m^2/s].
double diffusivity(const Thermal& thermal, double density_kg_m3);

struct Relaxation {
  double strength = 0, time_s = 0;  // each >= 0
  friend bool operator==(const Relaxation&, const Relaxation&) = default;
};
using ModeHeat = std::array<Relaxation, kRelaxations>;

// Returns the decay rate [1/s] of a mode of angular frequency `omega_rad_s`: eta omega / 2.
double heat_loss(const ModeHeat& heat, double omega_rad_s);

// Returns the relaxations with all strengths and all times multiplied.
ModeHeat multiplied(const ModeHeat& heat, double strength, double time);

}  // namespace ringdown::modal
