#include "engine/bake/body_heat.h"

#include "engine/base/range.h"

#include <algorithm>

namespace ringdown::bake {
namespace {

static_assert(modal::kRelaxations == fem::kHeatPairs);

constexpr double kInsulates = 1e-6;  // conductivity of a part that does not say it; 0 would leave it no equation

// Rounds to four digits, which is more than a relaxation is known to: a bank holds eight of these numbers for each
// mode.
}  // namespace

BodyHeat::BodyHeat(const std::vector<modal::Material>& materials) {
  const auto warms = [](const modal::Material& material) { return material.thermal.has_value(); };
  const auto found = std::ranges::find_if(materials, warms);
  if (found == materials.end()) return;
  reference = *found;
  const double capacity = found->density_kg_m3 * found->thermal->heat_capacity_j_kgk;
  for (const modal::Material& material : materials) {
    if (!material.thermal) {
      parts.push_back({.expansion = 0, .conductivity = kInsulates});
      continue;
    }
    const auto& [expansion_per_k, conductivity_w_mk, heat_capacity_j_kgk] = *material.thermal;
    parts.push_back({expansion_per_k / found->thermal->expansion_per_k,
                     conductivity_w_mk / found->thermal->conductivity_w_mk,
                     material.density_kg_m3 * heat_capacity_j_kgk / capacity});
  }
}

modal::ModeHeat BodyHeat::relaxations(const Eigen::MatrixXd& pairs, const BodyUnits& units, Eigen::Index m) const {
  modal::ModeHeat relaxations{};
  if (!reference || pairs.size() == 0) return relaxations;
  const modal::Thermal& thermal = *reference->thermal;
  const double strength = modal::relaxation_strength(thermal, units.modulus_pa, reference->density_kg_m3);
  const double rate = modal::diffusivity(thermal, reference->density_kg_m3) / (units.length_m * units.length_m);
  for (int j = 0; j < modal::kRelaxations; ++j) {
    if (pairs(2 * j, m) > 0)
      relaxations[j] = {to_digits(strength * pairs(2 * j, m), 4), to_digits(1 / (rate * pairs(2 * j + 1, m)), 4)};
  }
  return relaxations;
}

}  // namespace ringdown::bake
