// The loudness of a mode from afar: the sound pressure at 1 m for a modal velocity of 1 kg^1/2 m/s.
//
// The level is rms over all directions, because the listener's place is not known here. It is computed from the best
// data that the bank has:
//
//   maps of radiation   rho omega |F|rms / 1 m: exact as far as the maps are (radiation_map.h)
//   triangles           rho c sqrt(sigma A / (4 pi)) phi.n rms / 1 m, with sigma = (ka)^2 / (1 + (ka)^2) and a the
//                       radius of the disc of area A, as the draft KHR_audio_rigid_bodies asks. The formula ignores
//                       cancellation between parts of the surface, so it overrates thin bodies by tens of dB.
//   neither             rho omega kUnknownFlow / 1 m: pressure follows acceleration, as from a small source. Shapes of
//                       recorded banks are made for this (engine/fit), so that such a bank sounds as it was recorded.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <cstddef>
#include <vector>

namespace ringdown::modal {

// The sound pressure at 1 m that is full scale by default [Pa]: 117 dB SPL of a steady tone.
inline constexpr double kFullScale_pa = 20;

// |F| [m^2 kg^-1/2] of a mode without map or surface: a modal acceleration of 1 kg^1/2 m/s^2 is then 1e-4 of the
// default full scale.
inline constexpr double kUnknownFlow = 1e-4 * kFullScale_pa / Air{}.density_kg_m3;

class Loudness {
 public:
  // O(modes x points) without maps. [worker]
  explicit Loudness(const Bank& bank);

  // Pascals at 1 m for a modal velocity of 1 of mode `m`, in another size and material in which the mode sounds at
  // frequency_hz. `bank` must be the constructor's. [any]
  [[nodiscard]] double pressure_pa(const Bank& bank, std::size_t m, const MaterialScale& scale,
                                   double frequency_hz) const;

 private:
  double area_m2_ = 0;
  std::vector<double> normal_rms_;  // rms of phi.n over the surface [kg^-1/2]; empty with maps or without triangles
};

// The air that a bank's modes radiate into.
inline Air air_of(const Bank& bank) { return bank.radiation ? bank.radiation->air : Air{}; }

}  // namespace ringdown::modal
