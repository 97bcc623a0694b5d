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

// Keeps the rows of the piece's rigid motions and of its modes that still ring under `scale`.
std::vector<float> ringing_rows(const PieceBank& piece, const MaterialScale& scale) {
  const std::size_t rows = kRigidMotions + piece.bank.mode_count(), columns = piece.handover.size() / rows;
  std::vector<float> kept;
  kept.reserve(piece.handover.size());
  for (std::size_t row = 0; row < rows; ++row) {
    if (row >= kRigidMotions && rescale(piece.bank, row - kRigidMotions, scale).frequency_hz == 0) continue;
    const auto from = piece.handover.begin() + static_cast<std::ptrdiff_t>(row * columns);
    kept.insert(kept.end(), from, from + static_cast<std::ptrdiff_t>(columns));
  }
  return kept;
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
  out.levels.reset();
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

Fracture scaled(const Fracture& fracture, const MaterialScale& scale) {
  Fracture out{.stress = scaled(fracture.stress, scale),
               .skin_m2 = scale.size * scale.size * fracture.skin_m2,
               .strength = fracture.strength,
               .crack_energy_j_m2 = fracture.crack_energy_j_m2 / scale.stiffness};
  for (const BreakPattern& pattern : fracture.patterns) {
    BreakPattern& changed = out.patterns.emplace_back();
    changed.at_m = scale.size * pattern.at_m;
    changed.crack_area_m2 = scale.size * scale.size * pattern.crack_area_m2;
    for (const PieceBank& piece : pattern.pieces) {
      changed.pieces.push_back({.bank = scaled(piece.bank, scale),
                                .handover = ringing_rows(piece, scale),
                                .near_m = scale.size * piece.near_m,
                                .far_m = scale.size * piece.far_m,
                                .model = piece.model});
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
    const StressTable& table = bank.fracture->stress;
    if (!all_finite(table.positions) || !finite(table.stress) || !finite(table.largest)) return false;
    return std::ranges::all_of(bank.fracture->patterns, [&](const BreakPattern& pattern) {
      return std::ranges::all_of(pattern.pieces, [&](const PieceBank& piece) {
        return all_finite(piece.bank.positions) && all_finite(piece.bank.shapes);
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
    }
  }
  bank.fracture = std::make_shared<const Fracture>(std::move(fracture));
}

}  // namespace ringdown::modal
