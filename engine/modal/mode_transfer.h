// What becomes of the modes that ring in an object when the object changes at once, as by the level of a liquid in it
// or by a tube under it. [any thread]
#pragma once

#include <vector>

namespace ringdown::modal {

// Matrices of M x M, row by row, from the old amplitudes of sqrt(2 energy) to the new ones: of velocity to velocity,
// and of omega times displacement to the same.
struct ModeTransfer {
  std::vector<double> velocity, displacement;
  std::vector<double> turn;  // of velocity to omega times displacement, and minus the other way; empty: all 0
};

}  // namespace ringdown::modal
