#include "engine/breaking/piece_set.h"

#include "engine/base/vec3.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/scaled_bank.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace ringdown::breaking {

std::vector<modal::DampedMode> modes_of(const modal::Bank& bank, const modal::MaterialScale& material) {
  const bool as_baked = material == modal::MaterialScale();
  std::vector<modal::DampedMode> modes(bank.mode_count());
  for (std::size_t m = 0; m < modes.size(); ++m)
    modes[m] = as_baked ? modal::DampedMode{bank.frequency_hz[m], bank.decay_per_s[m]} : rescale(bank, m, material);
  return modes;
}

namespace {

constexpr double kCrackSpeed_m_s = 1500;  // of fast cracks in glass, about half of the speed of Rayleigh waves

const modal::BreakPattern& pattern_of(const modal::Bank& body, std::size_t pattern) {
  assert(body.fracture && pattern < body.fracture->patterns.size());
  return body.fracture->patterns[pattern];
}

modal::BreakPattern scaled(const modal::BreakPattern& pattern, const modal::MaterialScale& material) {
  if (material == modal::MaterialScale()) return pattern;
  return std::move(modal::scaled(modal::Fracture{.patterns = {pattern}}, material).patterns[0]);
}

modal::Breaking breaking_of(const modal::Bank& body, const modal::MaterialScale& material,
                            const modal::BreakPattern& pattern) {
  std::vector<modal::Piece> pieces;
  double crack_m = 0;
  for (const modal::PieceBank& piece : pattern.pieces) {
    const std::size_t rows = modal::kRigidMotions + piece.bank.mode_count();
    pieces.push_back({.mass = *piece.bank.mass,
                      .modes = modes_of(piece.bank),
                      .handover = {rows, piece.handover.size() / rows, piece.handover},
                      .delay_s = piece.near_m / kCrackSpeed_m_s});
    crack_m += (piece.far_m - piece.near_m) / static_cast<double>(pattern.pieces.size());
  }
  return {modes_of(body, material), rescale(*body.mass, material), pieces, crack_m / kCrackSpeed_m_s};
}

}  // namespace

PieceSet::PieceSet(const modal::StrikeMap& body, const modal::MaterialScale& material, std::size_t pattern)
    : pattern_(pattern),
      breaking_(breaking_of(body.bank(), material, scaled(pattern_of(body.bank(), pattern), material))) {
  const modal::BreakPattern& whole = pattern_of(body.bank(), pattern);
  const modal::BreakPattern in_material = scaled(whole, material);
  for (std::size_t i = 0; i < whole.pieces.size(); ++i) {
    const modal::PieceBank& piece = in_material.pieces[i];
    BodyPiece& made = pieces_.emplace_back(BodyPiece{.mass = *piece.bank.mass,
                                                     .modes = modes_of(piece.bank),
                                                     .delay_s = piece.near_m / kCrackSpeed_m_s,
                                                     .model = piece.model});
    std::vector<Vec3>& points = points_.emplace_back();
    for (const modal::Vec3f& p : piece.bank.positions) points.push_back({p[0], p[1], p[2]});
    if (whole.pieces[i].bank.mode_count() == 0) continue;
    modal::Bank own = whole.pieces[i].bank;
    own.gain = body.bank().gain;
    if (!own.fracture) own.fracture = fracture_of_piece(*body.bank().fracture, pattern, i);
    made.map = std::make_shared<const modal::StrikeMap>(std::make_shared<const modal::Bank>(std::move(own)));
  }
}

std::size_t PieceSet::nearest(const Vec3& point_m) const {
  const auto distance = [&](const std::vector<Vec3>& points) {
    double min = HUGE_VAL;
    for (const Vec3& p : points) min = std::min(min, length(p - point_m));
    return min;
  };
  return static_cast<std::size_t>(std::ranges::min_element(points_, {}, distance) - points_.begin());
}

}  // namespace ringdown::breaking
