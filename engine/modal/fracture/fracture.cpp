#include "engine/modal/fracture/fracture.h"

#include <utility>

namespace ringdown::modal {

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
