// The modes of the air in a vessel with a mouth, by boundary elements. [worker]
//
// The body's surface moves as a whole along three axes, and outward everywhere, one after the other. Their far fields,
// at some real wavenumbers, are functions of k whose poles kappa are the modes of the air (rational.h). Near a pole,
// with psi the mode's pressure, -laplace psi = kappa^2 psi, integral of psi^2 = 1,
//
//   P = c psi / (kappa^2 - k^2) + what is smooth,      c = integral of psi q over the walls
//
// so that two wavenumbers on both sides of the pole give c, psi on the walls, and its far field. Layers of friction and
// heat at the walls then take
//
//   1/Q = delta_v / (2 kappa^2) integral of |grad psi|^2  +  (gamma - 1) delta_t / 2 integral of psi^2    over the
//   walls
//
// and lower the pitch by 1/(2 Q) (Kirchhoff's layers, as in a wide tube). docs/how/cavities.md has the accuracy.
#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/modal/radiation_map.h"
#include "engine/radiate/body.h"

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace ringdown::cavity {

struct Vessel {
  const radiate::Body& body;  // its surface, and where samples of its flow lie [m]; what flows is not used
  Eigen::Vector3d origin;     // from which far fields are measured [m]
  Eigen::Vector3d mouth;      // the middle of the mouth [m]
  double lowest_hz = 0, highest_hz = 0;
  int modes = 1;    // the lowest
  int nodes = 600;  // of the finest of three skins, or of the part of it between mirror planes
};

// A mode of the air, of mass 1 as the modes of bodies are.
struct AirMode {
  double frequency_hz = 0;                  // with the layers at the walls
  double rigid_hz = 0;                      // without them
  double wall_q = 0;                        // of the walls' losses
  double wall_decay_per_s = 0;              // of the walls' losses
  double radiation_decay_per_s = 0;         // of what the mouth radiates
  double flux = 0;                          // volume out of the mouth for a coordinate of 1 [m^2 kg^-1/2]
  double frequency_error = 0;               // relative, estimated
  std::vector<std::complex<double>> field;  // F in harmonics [m^2 kg^-1/2]
};

// The lowest modes between the two frequencies, ascending: fewer than wanted where there are no more. Fails as
// radiate::solve() does, and when cancelled. Progress stage: "cavity". About 10 s of one core.
Result<std::vector<AirMode>> air_modes(const Vessel& vessel, const modal::Air& air, const Progress& progress = {});

}  // namespace ringdown::cavity
