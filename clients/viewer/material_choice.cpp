#include "clients/viewer/material_choice.h"

#include "engine/base/folders.h"
#include "engine/base/range.h"
#include "engine/materials/material_library.h"

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

using modal::Material;
using modal::MaterialScale;

constexpr Range kFactor{1e-3, 1e3}, kDampingFactor{0, 1e3};  // what /object/.../material takes

// The factor, or 1 when there is nothing to scale.
double ratio(double wanted, double bank) { return bank > 0 ? wanted / bank : 1; }

// The loss factor of either kind of material, in a mode of an undamped 1 kHz.
double loss_at_1_khz(const Material& material) {
  const double omega = modal::hz_to_rad_per_s(1000);
  return 2 * modal::mode_loss(material.damping_law(), omega * omega).material_per_s / omega;
}

double strength(const Material& material) {
  return modal::relaxation_strength(*material.thermal, material.youngs_modulus_pa, material.density_kg_m3);
}

bool near(double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b)); }

std::string change_of(double relative) {
  return formatted("{:.1f} % {}", 100 * std::abs(relative), relative > 0 ? "higher" : "lower");
}

}  // namespace

MaterialChoice choice_of(const Material& bank, const Material& wanted) {
  MaterialChoice choice;
  if (!(bank.youngs_modulus_pa > 0 && bank.density_kg_m3 > 0)) {
    choice.obstacle = "The bank does not state its stiffness and density.";
    return choice;
  }
  MaterialScale& scale = choice.scale;
  scale.stiffness = wanted.youngs_modulus_pa / bank.youngs_modulus_pa;
  scale.density = wanted.density_kg_m3 / bank.density_kg_m3;
  const bool by_parts = !bank.loss_factors.empty();
  if (by_parts) {
    scale.beta = loss_at_1_khz(wanted) / loss_at_1_khz(bank);
    if (bank.thermal)
      scale.heat = wanted.thermal ? strength(wanted) / strength(bank) * scale.density / scale.stiffness : 0;
  } else {
    scale.alpha = ratio(wanted.damping.alpha_per_s, bank.damping.alpha_per_s);
    scale.beta = ratio(wanted.damping.beta_s, bank.damping.beta_s);
  }
  const double nu = bank.poisson_ratio, wanted_nu = wanted.poisson_ratio;
  choice.plate_error = std::sqrt((1 - nu * nu) / (1 - wanted_nu * wanted_nu)) - 1;
  choice.twist_error = std::sqrt((1 + nu) / (1 + wanted_nu)) - 1;
  if (!kFactor.holds(scale.stiffness) || !kFactor.holds(scale.density) || !kDampingFactor.holds(scale.alpha) ||
      !kDampingFactor.holds(scale.beta) || !kDampingFactor.holds(scale.heat)) {
    choice.obstacle = "A bank's stiffness, density and damping can be scaled by a factor of at most 1000.";
  }
  const bool lacks_alpha = !by_parts && bank.damping.alpha_per_s <= 0 && wanted.damping.alpha_per_s > 0;
  const bool lacks_beta = !by_parts && bank.damping.beta_s <= 0 && wanted.damping.beta_s > 0;
  if (lacks_alpha || lacks_beta) {
    choice.reservation = std::string("The bank has no damping of ") +
                         (lacks_alpha && lacks_beta ? "its own"
                          : lacks_alpha             ? "low modes (alpha)"
                                                    : "high modes (beta)") +
                         " that could be scaled, so this damping does not change.";
  }
  return choice;
}

std::vector<Material> known_materials(const std::filesystem::path& given) {
  std::vector<Material> known;
  const auto folder = material_folder(given);
  if (!folder) return known;
  for (const std::string& name : bake::names_in(*folder)) {
    if (const auto entry = bake::find_material(*folder, name)) known.push_back(entry->material);
  }
  return known;
}

std::string material_name(const Material& bank, const MaterialScale& scale, const std::vector<Material>& known) {
  const auto fits = [&](const MaterialScale& s) {
    return near(s.alpha, scale.alpha) && near(s.beta, scale.beta) && near(s.heat, scale.heat) &&
           near(s.density, scale.density) && near(s.stiffness, scale.stiffness);
  };
  if (fits({})) return bank.name;
  for (const Material& material : known) {
    const MaterialChoice choice = choice_of(bank, material);
    if (choice.obstacle.empty() && fits(choice.scale)) return material.name;
  }
  return "";
}

std::string describe(const Material& bank, const Material& wanted) {
  const MaterialChoice choice = choice_of(bank, wanted);
  std::string sentences = formatted("Young's modulus {:.3g} GPa, density {:.0f} kg/m3, Poisson's ratio {:.2f}.\n",
                                    1e-9 * wanted.youngs_modulus_pa, wanted.density_kg_m3, wanted.poisson_ratio);
  if (!choice.obstacle.empty()) return sentences + choice.obstacle + "\nBake the object in this material instead.";
  if (near(bank.poisson_ratio, wanted.poisson_ratio)) {
    sentences += "Poisson's ratio is the bank's: all frequencies are exact.";
  } else {
    sentences += formatted(
        "Poisson's ratio stays the bank's {:.2f} until the object is baked again. With {:.2f}, plates would\nsound {} "
        "and twisting modes {}; bars that bend would not change.",
        bank.poisson_ratio, wanted.poisson_ratio, change_of(choice.plate_error), change_of(choice.twist_error));
  }
  return sentences + (choice.reservation.empty() ? "" : "\n" + choice.reservation);
}

}  // namespace ringdown::viewer
