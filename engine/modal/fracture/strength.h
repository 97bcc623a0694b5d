// When a body breaks, and what the crack costs. [any]
//
// The strength of a brittle body scatters, and a large body is weaker than a small one, because it is more likely to
// have a bad flaw in its skin. By Weibull's law (J. Appl. Mech. 18, 1951) the probability that a body whose skin has
// the area A survives a stress sigma is exp(-(A / A_0) (sigma / sigma_0)^m).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace ringdown::modal {

// The stretched area that a material's strength refers to unless it is said: by convention, 10 cm2.
inline constexpr double kReferenceArea_m2 = 1e-3;

struct Strength {
  double strength_pa = 0;                        // sigma_0 > 0: 63 % of all specimens break below
  double weibull_modulus = 1;                    // m >= 1; glass 5 to 7, porcelain 10 to 15
  double reference_area_m2 = kReferenceArea_m2;  // A_0 > 0
};

// The constants of a brittle material. Ductile materials have none of them and never break.
struct Brittleness {
  Strength strength;
  double toughness_pa_sqrt_m = 0;  // K_Ic > 0
};

// Returns the strength that half of all bodies of this skin area have [Pa]. `area_m2` > 0.
double median_strength_pa(const Strength& strength, double area_m2);

// Returns the strength of one body [Pa]: sigma_0 (A_0/A)^(1/m) (-ln u)^(1/m), with u in (0, 1) drawn by hashing the
// scene's seed and the body's number. Nothing else that is drawn or happens changes it. `area_m2` > 0.
double drawn_strength_pa(const Strength& strength, double area_m2, std::uint64_t scene_seed, std::uint64_t body);

// Returns the energy of a crack for each area of it [J/m^2], G_c = K_Ic^2 (1 - nu^2) / E (Irwin 1957, plane strain).
// The toughness K_Ic is in Pa m^1/2.
double crack_energy_j_m2(double toughness_pa_sqrt_m, double youngs_modulus_pa, double poisson_ratio);

// Fast cracks branch and are rough, so that they cost several times G_c.
inline constexpr double kFractureEnergyFactor = 3;

// Returns the energy of a crack of this area [J], which BasicBreaking takes from the body's modes.
inline double crack_cost_j(double crack_area_m2, double energy_j_m2, double factor = kFractureEnergyFactor) {
  return crack_area_m2 * energy_j_m2 * factor;
}

// Returns the last of several levels, coarse to fine, whose crack costs at most `available_j`; nothing when none does.
// `crack_areas_m2` has the area of each level's cracks, counted once, not on both sides.
std::optional<std::size_t> finest_affordable(std::span<const double> crack_areas_m2, double energy_j_m2,
                                             double available_j, double factor = kFractureEnergyFactor);

}  // namespace ringdown::modal
