#include "engine/materials/material_change.h"

#include "engine/materials/importance.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/hearing/pitch.h"
#include "engine/modal/material_scale.h"
#include "engine/modal/mode_choice.h"
#include "engine/modal/scaled_bank.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

// The factors on lengths, stiffness and density; damping follows below.
modal::MaterialScale scale_of(const modal::Material& from, const modal::Material& to, const Change& change) {
  if (!change.material) return {.size = change.size};
  return {.density = to.density_kg_m3 / from.density_kg_m3,
          .stiffness = to.youngs_modulus_pa / from.youngs_modulus_pa,
          .size = change.size};
}

double lambda_of(const modal::Bank& bank, std::size_t m, const modal::MaterialScale& scale) {
  return modal::lambda_factor(scale) * modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
}

// Rayleigh's alpha as the loss to air and support. With a list of loss factors, alpha belongs to the material's fit, so
// this is 0.
double alpha_of(const modal::Material& material) {
  return material.loss_factors.empty() ? material.damping.alpha_per_s : 0.0;
}

// The relaxations of the mode in another material of the same Poisson's ratio; none where one of the two does not say
// how it warms.
modal::ModeHeat heat_in(const modal::Material& from, const modal::Material& to, const modal::Bank& bank, std::size_t m,
                        const modal::MaterialScale& scale) {
  if (bank.heat.empty() || !from.thermal || !to.thermal) return {};
  const double strength = modal::relaxation_strength(*to.thermal, to.youngs_modulus_pa, to.density_kg_m3) /
                          modal::relaxation_strength(*from.thermal, from.youngs_modulus_pa, from.density_kg_m3);
  const double time = scale.size * scale.size * modal::diffusivity(*from.thermal, from.density_kg_m3) /
                      modal::diffusivity(*to.thermal, to.density_kg_m3);
  return modal::multiplied(bank.heat[m], strength, time);
}

// The losses of the mode in another material. The loss to air and support together scales as the two materials' alphas:
// a bank whose support takes more than its material says keeps that ratio. What supports take of a material without
// alpha follows the body's size and density alone.
modal::ModeLoss loss_in(const modal::Material& from, const modal::Material& to, const modal::Bank& bank, std::size_t m,
                        const modal::MaterialScale& scale, const modal::ModeHeat& heat) {
  modal::ModeLoss loss =
      modal::mode_loss(to.damping_law(), lambda_of(bank, m, scale), modal::rescaled_air_loss(bank, m, scale));
  loss.material_per_s *= modal::material_share(bank, m);
  loss.heat_per_s = modal::heat_loss(heat, std::sqrt(lambda_of(bank, m, scale)));
  const modal::ModeLoss baked = modal::loss_of(bank, m);
  if (!from.loss_factors.empty()) {
    loss.support_per_s += baked.support_per_s / (scale.density * scale.size);
    return loss;
  }
  const double alpha = alpha_of(from), wanted_alpha = alpha_of(to);
  if (!to.loss_factors.empty()) {
    const double of_alpha = std::max(0.5 * alpha - baked.air_per_s, 0.0);
    loss.support_per_s = std::max(baked.support_per_s - of_alpha, 0.0) / (scale.density * scale.size);
    return loss;
  }
  const double taken = baked.support_per_s + std::min(baked.air_per_s, 0.5 * alpha);
  const double wanted = alpha > 0 ? taken * (wanted_alpha / alpha) : taken + 0.5 * wanted_alpha;
  loss.support_per_s = std::max(wanted - loss.air_per_s, 0.0);
  return loss;
}

double rms_shape(const modal::Bank& bank, std::size_t mode) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const double component : bank.shape(mode, p)) sum += component * component;
  }
  return std::sqrt(sum / static_cast<double>(bank.point_count()));
}

// The frequency at which an end of the band comes to lie after the change, found by its eigenvalue.
double changed_bound(double frequency_hz, const modal::Material& from, const modal::Material& to, double factor) {
  if (frequency_hz <= 0) return 0;
  const double lambda = factor * modal::highest_lambda(frequency_hz, from.damping_law());
  return modal::with_decay(lambda, modal::mode_loss(to.damping_law(), lambda).total_per_s()).frequency_hz;
}

// The bank after the change, which may have no mode left, and the old numbers of its modes.
struct Kept {
  modal::Bank bank;
  std::vector<std::size_t> order;
};
Kept changed_bank(const modal::Bank& bank, const Change& change);

// Each piece changes as a body of its own, of the body's old material. Strength and toughness become those of the new
// material; a ductile one has none.
modal::Fracture changed_pieces(const modal::Fracture& fracture, const Change& change, const modal::MaterialScale& scale,
                               const std::optional<modal::Material>& from, const modal::Material& to) {
  modal::Fracture out = modal::resized(fracture, scale);
  for (std::size_t p = 0; p < out.patterns.size(); ++p) {
    for (std::size_t i = 0; i < out.patterns[p].pieces.size(); ++i) {
      modal::Bank whole = fracture.patterns[p].pieces[i].bank;
      const std::size_t modes = whole.mode_count();
      whole.material = from;
      Kept kept = changed_bank(whole, change);
      out.patterns[p].pieces[i].bank = std::move(kept.bank);
      take_modes_of_piece(out, p, i, modes, kept.order);
    }
  }
  if (!change.material) return out;
  out.strength.reset();
  out.crack_energy_j_m2 = 0;
  if (!to.brittleness) return out;
  out.strength = to.brittleness->strength;
  out.crack_energy_j_m2 =
      modal::crack_energy_j_m2(to.brittleness->toughness_pa_sqrt_m, to.youngs_modulus_pa, to.poisson_ratio);
  return out;
}

Kept changed_bank(const modal::Bank& bank, const Change& change) {
  const modal::Material from = bank.material.value_or(modal::Material{});
  modal::Material to = change.material.value_or(from);
  to.poisson_ratio = from.poisson_ratio;
  const modal::MaterialScale scale = scale_of(from, to, change);
  to.orthotropy = from.orthotropy;
  if (to.orthotropy) to.orthotropy = modal::stiffer(*to.orthotropy, scale.stiffness);

  Kept changed{.bank = bank, .order = {}};
  modal::Bank& out = changed.bank;
  const modal::Loudness loudness(bank);
  std::vector<modal::DampedMode> modes;
  std::vector<modal::ModeHeat> heat;
  std::vector<modal::ModeLoss> losses;
  std::vector<double> weights;
  std::vector<std::size_t>& order = changed.order;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    heat.push_back(change.material ? heat_in(from, to, bank, m, scale) : modal::rescaled_heat(bank, m, scale));
    losses.push_back(change.material ? loss_in(from, to, bank, m, scale, heat[m])
                                     : modal::rescaled_loss(bank, m, scale));
    modes.push_back(modal::with_decay(lambda_of(bank, m, scale), losses[m].total_per_s()));
    const double pressure_pa = loudness.pressure_pa(bank, m, scale, modes[m].frequency_hz);
    weights.push_back(importance(modes[m], pressure_pa, rms_shape(bank, m)));
    if (modes[m].frequency_hz > 0) order.push_back(m);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });

  const auto shape = static_cast<float>(modal::shape_factor(scale));
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    out.frequency_hz[m] = modes[m].frequency_hz;
    out.decay_per_s[m] = modes[m].decay_per_s;
    if (!bank.losses.empty()) out.losses[m] = losses[m];
    if (bank.radiation) out.radiation->maps.modes[m] = modal::rescale(bank.radiation->maps.modes[m], scale);
  }
  if (!bank.heat.empty()) out.heat = std::move(heat);
  for (modal::Vec3f& s : out.shapes) s = {shape * s[0], shape * s[1], shape * s[2]};
  if (out.radiation) out.radiation->maps.origin_m = scale.size * out.radiation->maps.origin_m;
  if (out.nonlinear) modal::rescale(*out.nonlinear, scale);
  modal::take_modes(out, order);
  for (modal::Vec3f& point : out.positions) point = modal::rescale(point, scale);
  if (out.fracture)
    out.fracture =
        std::make_shared<const modal::Fracture>(changed_pieces(*out.fracture, change, scale, bank.material, to));
  if (out.mass) out.mass = modal::rescale(*out.mass, scale);
  out.pitch_hz = modal::scaled_pitch(bank.pitch_hz, scale);
  if (bank.material) out.material = to;
  const double factor = modal::lambda_factor(scale);
  modal::Provenance& made = out.provenance;
  made.band_low_hz = changed_bound(made.band_low_hz, from, to, factor);
  made.band_high_hz = changed_bound(made.band_high_hz, from, to, factor);
  return changed;
}

}  // namespace

Result<Changed> change(const modal::Bank& bank, const Change& change) {
  if (change.material && !(bank.material && bank.material->youngs_modulus_pa > 0 && bank.material->density_kg_m3 > 0))
    return fail(ErrorKind::bad_input, "the bank does not name its material, so only its size can be changed");
  Kept kept = changed_bank(bank, change);
  if (kept.order.empty()) return fail(ErrorKind::bad_input, "none of its modes would ring: all are over-damped");
  return Changed{.bank = std::move(kept.bank), .over_damped = bank.mode_count() - kept.order.size()};
}

}  // namespace ringdown::bake
