#include "engine/modal/fracture/strength.h"

#include <cassert>
#include <cmath>

namespace ringdown::modal {
namespace {

// The finaliser of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014): changes each output bit with probability near 1/2
// when one input bit changes.
std::uint64_t mixed_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Returns the stress that the share `surviving` of all bodies of this skin area survives.
double survived_stress_pa(const Strength& strength, double area_m2, double surviving) {
  assert(strength.strength_pa > 0 && strength.weibull_modulus >= 1 && strength.reference_area_m2 > 0 && area_m2 > 0);
  return strength.strength_pa *
         std::pow(-std::log(surviving) * strength.reference_area_m2 / area_m2, 1 / strength.weibull_modulus);
}

}  // namespace

double median_strength_pa(const Strength& strength, double area_m2) {
  return survived_stress_pa(strength, area_m2, 0.5);
}

double drawn_strength_pa(const Strength& strength, double area_m2, std::uint64_t scene_seed, std::uint64_t body) {
  const std::uint64_t bits = mixed_bits(mixed_bits(scene_seed) ^ body) >> 11;
  const double u = (static_cast<double>(bits) + 0.5) / 9007199254740992.0;  // 2^53
  return survived_stress_pa(strength, area_m2, u);
}

double crack_energy_j_m2(double toughness_pa_sqrt_m, double youngs_modulus_pa, double poisson_ratio) {
  return toughness_pa_sqrt_m * toughness_pa_sqrt_m * (1 - poisson_ratio * poisson_ratio) / youngs_modulus_pa;
}

std::optional<std::size_t> finest_affordable(std::span<const double> crack_areas_m2, double energy_j_m2,
                                             double available_j, double factor) {
  for (std::size_t level = crack_areas_m2.size(); level-- > 0;) {
    if (crack_cost_j(crack_areas_m2[level], energy_j_m2, factor) <= available_j) return level;
  }
  return {};
}

}  // namespace ringdown::modal
