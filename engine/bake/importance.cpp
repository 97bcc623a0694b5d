#include "engine/bake/importance.h"

#include <cmath>

namespace ringdown::bake {

double a_weighting(double frequency_hz) {
  const double f2 = frequency_hz * frequency_hz;
  const auto squared = [](double x) { return x * x; };
  const double response =
      squared(12194) * f2 * f2 /
      ((f2 + squared(20.6)) * std::sqrt((f2 + squared(107.7)) * (f2 + squared(737.9))) * (f2 + squared(12194)));
  return response * std::pow(10.0, 2.0 / 20);
}

double importance(modal::DampedMode mode, double surface_rms) {
  constexpr double kIntegrationSeconds = 0.2, kContactSeconds = 3e-4;
  const double frequency = mode.frequency_hz, side = 2 * frequency * kContactSeconds;
  const double amplitude = modal::hz_to_rad_per_s(frequency) * surface_rms * a_weighting(frequency) / (1 + side * side);
  const double x = 2 * mode.decay_per_s * kIntegrationSeconds;
  const double collected = kIntegrationSeconds * (x > 1e-12 ? -std::expm1(-x) / x : 1.0);
  return amplitude * amplitude * collected;
}

}  // namespace ringdown::bake
