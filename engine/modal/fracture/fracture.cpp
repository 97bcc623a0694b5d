#include "engine/modal/fracture/fracture.h"

#include "engine/modal/scaled_bank.h"

#include <algorithm>
#include <utility>

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

}  // namespace

Fracture scaled(const Fracture& fracture, const MaterialScale& scale) {
  Fracture out;
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

void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept) {
  for (BreakPattern& pattern : fracture.patterns) {
    for (PieceBank& piece : pattern.pieces) {
      const std::size_t rows = kRigidMotions + piece.bank.mode_count(), columns = kRigidMotions + modes;
      std::vector<float> chosen;
      chosen.reserve(rows * (kRigidMotions + kept.size()));
      for (std::size_t row = 0; row < rows; ++row) {
        const float* const from = piece.handover.data() + row * columns;
        chosen.insert(chosen.end(), from, from + kRigidMotions);
        for (const std::size_t m : kept) chosen.push_back(from[kRigidMotions + m]);
      }
      piece.handover = std::move(chosen);
    }
  }
}

}  // namespace ringdown::modal
