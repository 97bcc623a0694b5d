#include "engine/modal/material_scale.h"

#include "engine/base/formatted.h"

#include <algorithm>

namespace ringdown::modal {
namespace {

double lambda_of(const Bank& bank, std::size_t m) {
  return undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
}

// Returns the loss to heat in the scaled body [1/s]. If the bank does not say how a mode relaxes, its loss factor
// stays.
double rescaled_heat_loss(const Bank& bank, std::size_t m, double heat_per_s, const MaterialScale& scale) {
  const double root = std::sqrt(lambda_factor(scale));
  if (bank.heat.empty()) return scale.heat * root * heat_per_s;
  return heat_loss(rescaled_heat(bank, m, scale), root * std::sqrt(lambda_of(bank, m)));
}

// The losses of a mode whose material is a list of loss factors.
ModeLoss rescaled_by_parts(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  const ModeLoss& baked = bank.losses[m];
  const MaterialDamping law = bank.material->damping_law();
  const double lambda = lambda_of(bank, m), scaled_lambda = lambda_factor(scale) * lambda;
  const double material = mode_loss(law, scaled_lambda).material_per_s / mode_loss(law, lambda).material_per_s;
  return {.material_per_s = scale.beta * material * baked.material_per_s,
          .air_per_s = scale.air * rescaled_air_loss(bank, m, scale),
          .support_per_s = scale.alpha * baked.support_per_s / (scale.density * scale.size),
          .heat_per_s = rescaled_heat_loss(bank, m, baked.heat_per_s, scale)};
}

// Returns the rms of F in the scaled body over that in the original, apart from the scaling of shapes by size and
// density.
double level_factor(const FarField& field, const MaterialScale& scale) {
  if (scale.stiffness == scale.density) return 1;
  return level_ratio(field, field.wavenumber_rad_m * std::sqrt(scale.stiffness / scale.density));
}

}  // namespace

std::string describe_damping(const Material& material) {
  const auto& list = material.loss_factors;
  if (list.empty()) {
    return formatted("alpha = {:.4g} 1/s, beta = {:.4g} s", material.damping.alpha_per_s, material.damping.beta_s);
  }
  if (list.size() == 1) return formatted("loss factor {:.3g}", list.front().eta);
  return formatted("loss factor {:.3g} at {:.4g} Hz to {:.3g} at {:.4g} Hz", list.front().eta,
                   list.front().frequency_hz, list.back().eta, list.back().frequency_hz);
}

double material_share(const Bank& bank, std::size_t m) {
  constexpr double kRounding = 1e-4;
  if (bank.losses.empty() || !bank.material) return 1;
  const double whole = mode_loss(bank.material->damping_law(), lambda_of(bank, m)).material_per_s;
  const double share = whole > 0 ? bank.losses[m].material_per_s / whole : 1;
  return std::abs(share - 1) > kRounding ? share : 1;
}

ModeLoss loss_of(const Bank& bank, std::size_t m) {
  if (!bank.losses.empty()) return bank.losses[m];
  const double beta = bank.material ? bank.material->damping.beta_s : 0.0;
  const double material = std::min(0.5 * beta * lambda_of(bank, m), bank.decay_per_s[m]);
  return {.material_per_s = material, .support_per_s = bank.decay_per_s[m] - material};
}

ModeHeat rescaled_heat(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  if (bank.heat.empty()) return {};
  return multiplied(bank.heat[m], scale.heat * scale.stiffness / scale.density,
                    scale.size * scale.size * scale.density);
}

double rescaled_air_loss(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  const double share = loss_of(bank, m).air_per_s / (scale.density * scale.size);
  if (!bank.radiation || scale.stiffness == scale.density) return share;
  const double level = level_factor(bank.radiation->maps.modes[m], scale);
  return share * level * level * scale.stiffness / scale.density;
}

ModeLoss rescaled_loss(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  const ModeLoss baked = loss_of(bank, m);
  if (scale == MaterialScale{}) return baked;
  if (bank.material && !bank.material->loss_factors.empty() && !bank.losses.empty())
    return rescaled_by_parts(bank, m, scale);
  const double factor = lambda_factor(scale);
  ModeLoss loss{.material_per_s = scale.beta * factor * baked.material_per_s,
                .air_per_s = scale.air * rescaled_air_loss(bank, m, scale),
                .heat_per_s = rescaled_heat_loss(bank, m, baked.heat_per_s, scale)};
  const double alpha = bank.material ? bank.material->damping.alpha_per_s : 0.0;
  const double air_and_support = baked.support_per_s + std::min(baked.air_per_s, 0.5 * alpha);
  loss.support_per_s = std::max(scale.alpha * air_and_support - loss.air_per_s, 0.0);
  return loss;
}

FarField rescale(const FarField& field, const MaterialScale& scale) {
  FarField scaled = field;
  const double shape_and_area = std::sqrt(scale.size / scale.density);
  const auto all = static_cast<float>(shape_and_area * level_factor(field, scale));
  scaled.wavenumber_rad_m *= std::sqrt(scale.stiffness / scale.density) / scale.size;
  scaled.unit *= all;
  for (FarField::Term& term : scaled.terms) term.value *= all;
  for (FarField::Level& level : scaled.levels) {
    level.wavenumber_rad_m = static_cast<float>(level.wavenumber_rad_m / scale.size);
    level.rms *= static_cast<float>(shape_and_area);
  }
  return scaled;
}

DampedMode rescale(const Bank& bank, std::size_t m, const MaterialScale& scale) {
  if (scale == MaterialScale{}) return {bank.frequency_hz[m], bank.decay_per_s[m]};
  return with_decay(lambda_factor(scale) * lambda_of(bank, m), rescaled_loss(bank, m, scale).total_per_s());
}

}  // namespace ringdown::modal
