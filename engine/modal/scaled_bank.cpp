#include "engine/modal/scaled_bank.h"

#include "engine/modal/fracture/fracture.h"
#include "engine/modal/hearing/pitch.h"
#include "engine/modal/mode_choice.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::modal {
namespace {

std::vector<std::size_t> ringing_modes(const Bank& bank, const MaterialScale& scale) {
  std::vector<std::size_t> ringing;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (rescale(bank, m, scale).frequency_hz > 0) ringing.push_back(m);
  }
  return ringing;
}

StressTable scaled(const StressTable& table, const MaterialScale& scale) {
  StressTable out = table;
  const auto factor = static_cast<float>(stress_factor(scale));
  for (Vec3f& point : out.positions) point = rescale(point, scale);
  for (float& stress : out.stress) stress *= factor;
  for (float& largest : out.largest) largest *= factor;
  return out;
}

}  // namespace

Bank scaled(const Bank& bank, const MaterialScale& scale) {
  Bank out = bank;
  const std::vector<std::size_t> ringing = ringing_modes(bank, scale);
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const DampedMode mode = rescale(bank, m, scale);
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
  out.levels.reset();
  if (out.cavity) {
    out.cavity->mouth_m = scale.size * out.cavity->mouth_m;
    out.cavity->diameter_m *= scale.size;
    for (Cavity::Mode& mode : out.cavity->modes) mode.flux *= shape_factor(scale) * scale.size * scale.size;
  }
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
  if (bank.fracture) out.fracture = std::make_shared<const Fracture>(scaled(*bank.fracture, scale));
  if (ringing.size() < bank.mode_count()) take_modes(out, ringing);
  return out;
}

Fracture resized(const Fracture& fracture, const MaterialScale& scale) {
  Fracture out = fracture;
  const double area = scale.size * scale.size;
  out.stress = scaled(fracture.stress, scale);
  out.skin_m2 *= area;
  out.crack_energy_j_m2 /= scale.stiffness;
  for (BreakPattern& pattern : out.patterns) {
    pattern.at_m = scale.size * pattern.at_m;
    pattern.crack_area_m2 *= area;
    for (PieceBank& piece : pattern.pieces) {
      piece.near_m *= scale.size;
      piece.far_m *= scale.size;
      piece.crack_area_m2 *= area;
      piece.skin_m2 *= area;
      piece.stress = scaled(piece.stress, scale);
    }
  }
  return out;
}

Fracture scaled(const Fracture& fracture, const MaterialScale& scale) {
  Fracture out = resized(fracture, scale);
  for (std::size_t p = 0; p < out.patterns.size(); ++p) {
    for (std::size_t i = 0; i < out.patterns[p].pieces.size(); ++i) {
      const Bank& bank = fracture.patterns[p].pieces[i].bank;
      const std::vector<std::size_t> ringing = ringing_modes(bank, scale);
      out.patterns[p].pieces[i].bank = scaled(bank, scale);
      if (ringing.size() < bank.mode_count()) take_modes_of_piece(out, p, i, bank.mode_count(), ringing);
    }
  }
  return out;
}

Result<void> scale_size(Bank& bank, double size, const std::string& name) {
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (rescale(bank, m, {.size = size}).frequency_hz > 0) continue;
    return fail(ErrorKind::bad_input, "{} mode {} is over-damped and has no pitch; bake the object at that size", name,
                m);
  }
  bank = scaled(bank, {.size = size});
  const auto finite = [](const std::vector<float>& numbers) {
    return std::ranges::all_of(numbers, [](float x) { return std::isfinite(x); });
  };
  const auto all_finite = [](const std::vector<Vec3f>& vectors) {
    return std::ranges::all_of(vectors, [](const Vec3f& v) { return std::isfinite(v[0] + v[1] + v[2]); });
  };
  const auto pieces_finite = [&] {
    if (!bank.fracture) return true;
    const auto table_finite = [&](const StressTable& table) {
      return all_finite(table.positions) && finite(table.stress) && finite(table.largest);
    };
    if (!table_finite(bank.fracture->stress)) return false;
    return std::ranges::all_of(bank.fracture->patterns, [&](const BreakPattern& pattern) {
      return std::ranges::all_of(pattern.pieces, [&](const PieceBank& piece) {
        return all_finite(piece.bank.positions) && all_finite(piece.bank.shapes) && table_finite(piece.stress);
      });
    });
  };
  if (!all_finite(bank.positions) || !all_finite(bank.shapes) || !pieces_finite() ||
      (bank.nonlinear && !(finite(bank.nonlinear->bending) && finite(bank.nonlinear->curving)))) {
    return fail(ErrorKind::bad_input, name + " its positions, shapes or nonlinear terms overflow");
  }
  return {};
}

void spread_points(Bank& bank, double factor) {
  const auto moved = [factor](float x) {
    return static_cast<float>(std::clamp(factor * static_cast<double>(x), -1e30, 1e30));
  };
  for (Vec3f& p : bank.positions) p = {moved(p[0]), moved(p[1]), moved(p[2])};
  if (bank.radiation) bank.radiation->maps.origin_m = factor * bank.radiation->maps.origin_m;
  if (bank.mass) bank.mass->center_of_mass_m = factor * bank.mass->center_of_mass_m;
  bank.levels.reset();
  if (!bank.fracture) return;
  Fracture fracture = *bank.fracture;
  for (Vec3f& p : fracture.stress.positions) p = {moved(p[0]), moved(p[1]), moved(p[2])};
  fracture.skin_m2 *= factor * factor;
  for (BreakPattern& pattern : fracture.patterns) {
    pattern.at_m = factor * pattern.at_m;
    pattern.crack_area_m2 *= factor * factor;
    for (PieceBank& piece : pattern.pieces) {
      spread_points(piece.bank, factor);
      piece.near_m *= factor;
      piece.far_m *= factor;
      piece.crack_area_m2 *= factor * factor;
      piece.skin_m2 *= factor * factor;
      for (Vec3f& p : piece.stress.positions) p = {moved(p[0]), moved(p[1]), moved(p[2])};
    }
  }
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
}

}  // namespace ringdown::modal
