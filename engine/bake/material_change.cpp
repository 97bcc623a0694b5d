#include "engine/bake/material_change.h"

#include "engine/bake/importance.h"
#include "engine/modal/material_scale.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace ringdown::bake {
namespace {

// Factors where there is something to multiply; `added` where there is not.
struct Scaling {
  modal::MaterialScale scale;
  modal::RayleighDamping added;
};

Scaling scaling_of(const modal::Material& from, const modal::Material& to, double size) {
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : 1.0; };
  const auto rest = [](double a, double b) { return b > 0 ? 0.0 : a; };
  return {
      .scale = {.alpha = ratio(to.damping.alpha_per_s, from.damping.alpha_per_s),
                .beta = ratio(to.damping.beta_s, from.damping.beta_s),
                .density = to.density_kg_m3 / from.density_kg_m3,
                .stiffness = to.youngs_modulus_pa / from.youngs_modulus_pa,
                .size = size},
      .added = {rest(to.damping.alpha_per_s, from.damping.alpha_per_s), rest(to.damping.beta_s, from.damping.beta_s)}};
}

modal::DampedMode changed_mode(const modal::Bank& bank, std::size_t m, const Scaling& scaling) {
  modal::DampedMode mode = modal::rescale(bank, m, scaling.scale);
  if (scaling.added == modal::RayleighDamping{}) return mode;
  const double lambda =
      modal::lambda_factor(scaling.scale) * modal::undamped_lambda({bank.frequency_hz[m], bank.decay_per_s[m]});
  mode.decay_per_s += 0.5 * (scaling.added.alpha_per_s + scaling.added.beta_s * lambda);
  const double omega_squared = lambda - mode.decay_per_s * mode.decay_per_s;
  mode.frequency_hz = omega_squared > 0 ? modal::rad_per_s_to_hz(std::sqrt(omega_squared)) : 0;
  return mode;
}

double rms_shape(const modal::Bank& bank, std::size_t mode) {
  double sum = 0;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const double component : bank.shape(mode, p)) sum += component * component;
  }
  return std::sqrt(sum / static_cast<double>(bank.point_count()));
}

// The frequency at which an end of the band comes to lie after the change, found by its eigenvalue.
double changed_bound(double frequency_hz, const modal::RayleighDamping& from, const modal::RayleighDamping& to,
                     double factor) {
  if (frequency_hz <= 0) return 0;
  return modal::damp(factor * modal::highest_lambda_in_band(frequency_hz, from), to).frequency_hz;
}

}  // namespace

Result<Changed> change(const modal::Bank& bank, const Change& change) {
  if (change.material && !(bank.material && bank.material->youngs_modulus_pa > 0 && bank.material->density_kg_m3 > 0))
    return fail(ErrorKind::bad_input,
                "the bank does not say what it is made of, so its material cannot be changed; change its size alone");
  const modal::Material from = bank.material.value_or(modal::Material{});
  modal::Material to = change.material.value_or(from);
  to.poisson_ratio = from.poisson_ratio;
  const Scaling scaling = change.material ? scaling_of(from, to, change.size) : Scaling{.scale = {.size = change.size}};

  Changed changed{.bank = bank};
  modal::Bank& out = changed.bank;
  std::vector<modal::DampedMode> modes;
  std::vector<double> weights;
  std::vector<std::size_t> order;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    modes.push_back(changed_mode(bank, m, scaling));
    weights.push_back(importance(modes[m], rms_shape(bank, m)));
    if (modes[m].frequency_hz > 0) order.push_back(m);
  }
  changed.over_damped = bank.mode_count() - order.size();
  if (order.empty()) return fail(ErrorKind::bad_input, "none of its modes still rings: all are over-damped");
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });

  const auto shape = static_cast<float>(modal::shape_factor(scaling.scale));
  out.frequency_hz.clear();
  out.decay_per_s.clear();
  out.frequency_error.clear();
  out.shape_error.clear();
  out.shapes.clear();
  for (const std::size_t m : order) {
    out.frequency_hz.push_back(modes[m].frequency_hz);
    out.decay_per_s.push_back(modes[m].decay_per_s);
    if (!bank.frequency_error.empty()) out.frequency_error.push_back(bank.frequency_error[m]);
    if (!bank.shape_error.empty()) out.shape_error.push_back(bank.shape_error[m]);
    for (std::size_t p = 0; p < bank.point_count(); ++p) {
      const modal::Vec3f& s = bank.shape(m, p);
      out.shapes.push_back({shape * s[0], shape * s[1], shape * s[2]});
    }
  }
  for (modal::Vec3f& point : out.positions) point = modal::rescale(point, scaling.scale);
  if (out.mass) out.mass = modal::rescale(*out.mass, scaling.scale);
  if (bank.material) out.material = to;
  const double factor = modal::lambda_factor(scaling.scale);
  modal::Provenance& made = out.provenance;
  made.band_low_hz = changed_bound(made.band_low_hz, from.damping, to.damping, factor);
  made.band_high_hz = changed_bound(made.band_high_hz, from.damping, to.damping, factor);
  return changed;
}

}  // namespace ringdown::bake
