#include "engine/modal/air_absorption.h"

#include <algorithm>
#include <cmath>

namespace ringdown::modal {
namespace {

constexpr double kZero_k = 273.15, kReference_k = 293.15, kTriplePoint_k = 273.16;

double kelvin(const AirConditions& conditions) REALTIME {
  return kZero_k + std::clamp(conditions.temperature_c, -50.0, 60.0);
}

}  // namespace

AirAbsorption::AirAbsorption(const AirConditions& conditions) REALTIME {
  const double t = kelvin(conditions), ratio = t / kReference_k;
  // Molar concentration of water vapour in percent, by the standard's annex B.
  const double saturation = std::pow(10, -6.8346 * std::pow(kTriplePoint_k / t, 1.261) + 4.6151);
  const double h = std::clamp(conditions.humidity_percent, 0.0, 100.0) * saturation;
  oxygen_relaxation_hz = 24 + 4.04e4 * h * (0.02 + h) / (0.391 + h);
  nitrogen_relaxation_hz = std::pow(ratio, -0.5) * (9 + 280 * h * std::exp(-4.170 * (std::pow(ratio, -1.0 / 3) - 1)));
  classical = 1.84e-11 * std::sqrt(ratio);
  const double relaxation = std::pow(ratio, -2.5);
  oxygen = relaxation * 0.01275 * std::exp(-2239.1 / t);
  nitrogen = relaxation * 0.1068 * std::exp(-3352.0 / t);
}

double sound_speed_m_s(const AirConditions& conditions) REALTIME {
  return 343.2 * std::sqrt(kelvin(conditions) / kReference_k);
}

}  // namespace ringdown::modal
