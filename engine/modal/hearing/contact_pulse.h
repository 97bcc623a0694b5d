// The force of a short contact: a half-sine of unit impulse and duration tau, centred on the strike's time.
#pragma once

#include "engine/base/realtime.h"

#include <cmath>
#include <numbers>

namespace ringdown::modal {

// Its spectrum at `frequency_hz`: F(f) = cos(pi f tau) / (1 - (2 f tau)^2), 1 at f = 0, pi/4 at f = 1 / (2 tau).
// Real, because the pulse is symmetric about the strike's time; negative in its odd side lobes. Written with
// sin(u)/u about the removable pole at 2 f tau = 1. tau = 0 is an ideal impulse: 1 everywhere. [audio]
inline double pulse_spectrum(double frequency_hz, double contact_time_s) REALTIME {
  const double x = 2 * frequency_hz * contact_time_s;
  const double u = 0.5 * std::numbers::pi * (1 - x);
  const double sinc = std::abs(u) < 1e-6 ? 1.0 : std::sin(u) / u;
  return 0.5 * std::numbers::pi * sinc / (1 + x);
}

}  // namespace ringdown::modal
