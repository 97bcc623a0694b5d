#include "engine/modal/fracture/fracture.h"

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

}  // namespace

void take_modes(Fracture& fracture, std::size_t modes, const std::vector<std::size_t>& kept) {
  take_modes(fracture.stress, modes, kept);
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
