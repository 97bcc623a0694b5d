// The absorption of sound by air, by ISO 9613-1 (1993), at the pressure of 101.325 kPa. [any thread]
#pragma once

#include "engine/base/realtime.h"

namespace ringdown::modal {

struct AirConditions {
  double temperature_c = 20;     // -50 to 60
  double humidity_percent = 50;  // relative, 0 to 100
  friend bool operator==(const AirConditions&, const AirConditions&) = default;
};

// The coefficients of the standard's equations 3 to 5, from which the absorption at any frequency follows:
//
//   alpha(f) = f^2 (classical + oxygen / (f_o + f^2 / f_o) + nitrogen / (f_n + f^2 / f_n))     [nepers per metre]
struct AirAbsorption {
  double classical = 0;                         // [s^2 / m]
  double oxygen = 0, oxygen_relaxation_hz = 1;  // [s / m], [Hz]
  double nitrogen = 0, nitrogen_relaxation_hz = 1;

  friend bool operator==(const AirAbsorption&, const AirAbsorption&) = default;

  AirAbsorption() = default;
  // Conditions outside their ranges are clamped.
  explicit AirAbsorption(const AirConditions& conditions) REALTIME;

  [[nodiscard]] double nepers_per_m(double frequency_hz) const REALTIME {
    const double f2 = frequency_hz * frequency_hz;
    return f2 * (classical + oxygen / (oxygen_relaxation_hz + f2 / oxygen_relaxation_hz) +
                 nitrogen / (nitrogen_relaxation_hz + f2 / nitrogen_relaxation_hz));
  }
};

// The speed of sound [m/s] in dry air at the temperature of `conditions`; 343.2 at 20 degrees.
double sound_speed_m_s(const AirConditions& conditions) REALTIME;

}  // namespace ringdown::modal
