#include "engine/modal/losses.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace ringdown::modal {

double loss_factor_at(std::span<const LossFactor> list, double frequency_hz) {
  assert(!list.empty());
  const auto above = std::ranges::upper_bound(list, frequency_hz, {}, &LossFactor::frequency_hz);
  if (above == list.begin()) return list.front().eta;
  if (above == list.end()) return list.back().eta;
  const LossFactor &low = *(above - 1), &high = *above;
  const double share = std::log(frequency_hz / low.frequency_hz) / std::log(high.frequency_hz / low.frequency_hz);
  return low.eta * std::pow(high.eta / low.eta, share);
}

RayleighDamping fit_rayleigh_to_list(std::span<const LossFactor> list) {
  std::vector<LossFactor> octaves;
  for (double frequency_hz = 125; frequency_hz <= 8000; frequency_hz *= 2)
    octaves.push_back({frequency_hz, loss_factor_at(list, frequency_hz)});
  return fit_rayleigh(octaves);
}

ModeLoss mode_loss(const MaterialDamping& damping, double lambda, double air_per_s) {
  if (damping.loss_factors.empty()) {
    const auto& [alpha_per_s, beta_s] = damping.rayleigh;
    return {.material_per_s = 0.5 * beta_s * lambda,
            .air_per_s = air_per_s,
            .support_per_s = std::max(0.5 * alpha_per_s - air_per_s, 0.0)};
  }
  const double omega = std::sqrt(lambda);
  return {.material_per_s = 0.5 * omega * loss_factor_at(damping.loss_factors, rad_per_s_to_hz(omega)),
          .air_per_s = air_per_s};
}

DampedMode with_decay(double lambda, double decay_per_s) {
  const double omega_squared = lambda - decay_per_s * decay_per_s;
  return {omega_squared > 0 ? rad_per_s_to_hz(std::sqrt(omega_squared)) : 0.0, decay_per_s};
}

// omega_d^2 = lambda (1 - eta^2 / 4), which rises with lambda unless eta rises steeply. The bisection goes between no
// loss at all and the list's largest.
double highest_lambda(double band_high_hz, const MaterialDamping& damping) {
  if (damping.loss_factors.empty()) return highest_lambda_in_band(band_high_hz, damping.rayleigh);
  constexpr double kMaxEta = 1.99;  // at 2 a mode is critically damped
  double max = 0;
  for (const LossFactor& point : damping.loss_factors) max = std::max(max, point.eta);
  max = std::min(max, kMaxEta);
  const double omega = hz_to_rad_per_s(band_high_hz);
  double low = omega * omega, high = low / (1 - max * max / 4);
  const auto in_band = [&](double lambda) {
    const DampedMode mode = with_decay(lambda, mode_loss(damping, lambda).material_per_s);
    return mode.frequency_hz > 0 && mode.frequency_hz <= band_high_hz;
  };
  if (in_band(high)) return high;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (in_band(middle) ? low : high) = middle;
  }
  return high;
}

double relaxation_strength(const Thermal& thermal, double youngs_modulus_pa, double density_kg_m3) {
  return youngs_modulus_pa * thermal.expansion_per_k * thermal.expansion_per_k * kRoomTemperature_k /
         (density_kg_m3 * thermal.heat_capacity_j_kgk);
}

double diffusivity(const Thermal& thermal, double density_kg_m3) {
  return thermal.conductivity_w_mk / (density_kg_m3 * thermal.heat_capacity_j_kgk);
}

double heat_loss(const ModeHeat& heat, double omega_rad_s) {
  double eta = 0;
  for (const auto& [strength, time_s] : heat) {
    const double x = omega_rad_s * time_s;
    eta += strength * x / (1 + x * x);
  }
  return 0.5 * eta * omega_rad_s;
}

ModeHeat multiplied(const ModeHeat& heat, double strength, double time) {
  ModeHeat result = heat;
  for (Relaxation& one : result) one = {strength * one.strength, time * one.time_s};
  return result;
}

}  // namespace ringdown::modal
