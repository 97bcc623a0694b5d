#include "engine/materials/importance.h"

#include <cmath>

// A mode counts by the energy that the ear collects of it: the sound pressure it starts with after a hard blow,
// weighted by the ear's sensitivity at its frequency, squared, times the time over which loudness builds up as far as
// the mode lasts.
namespace ringdown::bake {

double a_weighting(double frequency_hz) {
  const double f2 = frequency_hz * frequency_hz;
  const auto squared = [](double x) { return x * x; };
  const double response =
      squared(12194) * f2 * f2 /
      ((f2 + squared(20.6)) * std::sqrt((f2 + squared(107.7)) * (f2 + squared(737.9))) * (f2 + squared(12194)));
  return response * std::pow(10.0, 2.0 / 20);
}

double hard_contact(double frequency_hz) {
  constexpr double kContactSeconds = 3e-4;
  const double side = 2 * frequency_hz * kContactSeconds;
  return 1 / (1 + side * side);
}

double collected_s(double decay_per_s) {
  constexpr double kIntegrationSeconds = 0.2;
  const double x = 2 * decay_per_s * kIntegrationSeconds;
  return kIntegrationSeconds * (x > 1e-12 ? -std::expm1(-x) / x : 1.0);
}

double importance(modal::DampedMode mode, double pressure_pa, double surface_rms) {
  const double amplitude = pressure_pa * surface_rms * a_weighting(mode.frequency_hz) * hard_contact(mode.frequency_hz);
  return amplitude * amplitude * collected_s(mode.decay_per_s);
}

}  // namespace ringdown::bake
