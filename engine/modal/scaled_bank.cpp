#include "engine/modal/scaled_bank.h"

#include "engine/modal/hearing/pitch.h"
#include "engine/modal/mode_choice.h"

#include <vector>

namespace ringdown::modal {

Bank scaled(const Bank& bank, const MaterialScale& scale) {
  Bank out = bank;
  std::vector<std::size_t> ringing;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const DampedMode mode = rescale(bank, m, scale);
    if (mode.frequency_hz > 0) ringing.push_back(m);
    out.frequency_hz[m] = mode.frequency_hz;
    out.decay_per_s[m] = mode.decay_per_s;
    if (!bank.losses.empty()) out.losses[m] = rescaled_loss(bank, m, scale);
    if (!bank.heat.empty()) out.heat[m] = rescaled_heat(bank, m, scale);
    if (bank.radiation) out.radiation->maps.modes[m] = rescale(bank.radiation->maps.modes[m], scale);
  }
  const auto shape = static_cast<float>(shape_factor(scale));
  for (Vec3f& v : out.shapes) v = {shape * v[0], shape * v[1], shape * v[2]};
  for (Vec3f& point : out.positions) point = rescale(point, scale);
  if (out.radiation) out.radiation->maps.origin_m = scale.size * out.radiation->maps.origin_m;
  if (out.nonlinear) rescale(*out.nonlinear, scale);
  if (out.mass) out.mass = rescale(*out.mass, scale);
  if (out.material) {
    out.material->density_kg_m3 *= scale.density;
    out.material->youngs_modulus_pa *= scale.stiffness;
    out.material->damping.alpha_per_s *= scale.alpha;
    out.material->damping.beta_s *= scale.beta;
    for (LossFactor& point : out.material->loss_factors) point.eta *= scale.beta;
    if (out.material->orthotropy) out.material->orthotropy = stiffer(*out.material->orthotropy, scale.stiffness);
  }
  out.pitch_hz = scaled_pitch(bank.pitch_hz, scale);
  if (ringing.size() < bank.mode_count()) take_modes(out, ringing);
  return out;
}

}  // namespace ringdown::modal
