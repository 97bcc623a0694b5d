#include "engine/modal/fracture/fracture.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ringdown::modal {
namespace {

void take_modes(StressTable& table, std::size_t modes, const std::vector<std::size_t>& kept) {
  if (table.largest.empty()) return;
  std::vector<float> stress, largest;
  stress.reserve(table.stress.size() / modes * kept.size());
  for (std::size_t row = 0; row < 3 * table.positions.size(); ++row) {
    for (const std::size_t m : kept) stress.push_back(table.stress[row * modes + m]);
  }
  for (const std::size_t m : kept) largest.push_back(table.largest[m]);
  table.stress = std::move(stress);
  table.largest = std::move(largest);
}

// Returns the numbers of all rigid motions, and of these modes behind them.
std::vector<std::size_t> motions_of(const std::vector<std::size_t>& modes) {
  std::vector<std::size_t> motions(kRigidMotions);
  std::iota(motions.begin(), motions.end(), 0);
  for (const std::size_t m : modes) motions.push_back(kRigidMotions + m);
  return motions;
}

void take_rows(std::vector<float>& handover, std::size_t rows, const std::vector<std::size_t>& kept) {
  const std::size_t columns = handover.size() / rows;
  std::vector<float> chosen;
  chosen.reserve(kept.size() * columns);
  for (const std::size_t row : kept) {
    const float* const from = handover.data() + row * columns;
    chosen.insert(chosen.end(), from, from + columns);
  }
  handover = std::move(chosen);
}

void take_columns(std::vector<float>& handover, std::size_t columns, const std::vector<std::size_t>& kept) {
  std::vector<float> chosen;
  chosen.reserve(handover.size() / columns * kept.size());
  for (std::size_t row = 0; row < handover.size(); row += columns) {
    for (const std::size_t column : kept) chosen.push_back(handover[row + column]);
  }
  handover = std::move(chosen);
}

}  // namespace

std::vector<std::size_t> pieces_of_piece(const Fracture& fracture, std::size_t pattern, std::size_t piece) {
  std::vector<std::size_t> own;
  if (pattern + 1 >= fracture.patterns.size()) return own;
  const std::vector<PieceBank>& finer = fracture.patterns[pattern + 1].pieces;
  for (std::size_t i = 0; i < finer.size(); ++i) {
    if (finer[i].coarser == piece) own.push_back(i);
  }
  return own;
}

std::shared_ptr<const Fracture> fracture_of_piece(const Fracture& fracture, std::size_t pattern, std::size_t piece) {
  const std::vector<std::size_t> own = pieces_of_piece(fracture, pattern, piece);
  if (own.size() < 2) return nullptr;
  const PieceBank& whole = fracture.patterns[pattern].pieces[piece];
  BreakPattern parts{.at_m = fracture.patterns[pattern].at_m, .crack_area_m2 = whole.crack_area_m2, .pieces = {}};
  for (const std::size_t i : own) {
    const PieceBank& finer = fracture.patterns[pattern + 1].pieces[i];
    PieceBank& part = parts.pieces.emplace_back(PieceBank{.bank = finer.bank,
                                                          .handover = finer.from_coarser,
                                                          .near_m = finer.near_m - whole.near_m,
                                                          .far_m = finer.far_m - whole.near_m,
                                                          .model = finer.model});
    part.near_m = std::max(part.near_m, 0.0);
    part.far_m = std::max(part.far_m, part.near_m);
    part.bank.fracture = fracture_of_piece(fracture, pattern + 1, i);
  }
  return std::make_shared<const Fracture>(Fracture{.patterns = {std::move(parts)},
                                                   .stress = whole.stress,
                                                   .skin_m2 = whole.skin_m2,
                                                   .strength = fracture.strength,
                                                   .crack_energy_j_m2 = fracture.crack_energy_j_m2});
}

void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept) {
  take_modes(fracture.stress, modes, kept);
  const std::vector<std::size_t> columns = motions_of(kept);
  for (BreakPattern& pattern : fracture.patterns) {
    for (PieceBank& piece : pattern.pieces) take_columns(piece.handover, kRigidMotions + modes, columns);
  }
}

void take_modes_of_piece(Fracture& fracture, std::size_t pattern, std::size_t piece, std::size_t modes,
                         const std::vector<std::size_t>& kept) {
  const std::vector<std::size_t> motions = motions_of(kept);
  PieceBank& own = fracture.patterns[pattern].pieces[piece];
  take_modes(own.stress, modes, kept);
  take_rows(own.handover, kRigidMotions + modes, motions);
  if (own.coarser) take_rows(own.from_coarser, kRigidMotions + modes, motions);
  for (const std::size_t i : pieces_of_piece(fracture, pattern, piece))
    take_columns(fracture.patterns[pattern + 1].pieces[i].from_coarser, kRigidMotions + modes, motions);
}

}  // namespace ringdown::modal
