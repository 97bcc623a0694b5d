// One set of states for all objects that share a table, however many ring: a thousand coins for the price of two banks.
//
// What reaches an output is the sum of its objects' states, each times its object's gain there. While these gains stand
// still, the sum moves on just as each of them does (its poles are theirs), so it is enough to move on the sum; a
// strike is added to it times the object's gain. Beside it every object keeps states of its own, which are moved on
// only when it is struck, in one jump. When its gain or pan is about to move, these states are subtracted from the sum,
// and the object rings alone until it is still again.
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/ringing.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace ringdown::synth {

class Family {
 public:
  // An object's gain at each output: left, right, its bus.
  static constexpr std::size_t kOutputs = 3;
  using Shares = std::array<double, kOutputs>;

  // The table outlives it, or is not used any more. [worker]
  explicit Family(ModeTable& of) : table(of), sums{Ringing(of), Ringing(of), Ringing(of)} {}

  // Adds or, with negative shares, subtracts what rings in an object. [audio]
  void add(Ringing& states, const Shares& shares) RINGDOWN_REALTIME {
    for (std::size_t i = 0; i < kOutputs; ++i) {
      if (shares[i] != 0) sums[i].add(states, shares[i]);
    }
  }

  void silence() RINGDOWN_REALTIME {
    for (Ringing& sum : sums) sum.silence();
  }

  [[nodiscard]] bool ringing() const RINGDOWN_REALTIME {
    return sums[0].ringing() || sums[1].ringing() || sums[2].ringing();
  }

  // The mixer's own, on the audio thread.
  ModeTable& table;
  std::array<Ringing, kOutputs> sums;
  std::size_t bus = 0;      // channel of the third output; 0: none
  std::size_t members = 0;  // objects whose states it holds
  std::size_t struck = 0;   // of these, since it was last silent
  std::uint32_t round = 1;  // grows whenever it falls silent
  std::uint32_t lost = 0;   // grows when its states had to be thrown away
  bool active = false;      // on the mixer's list
  std::int32_t first_due = -1, last_due = -1;
};

}  // namespace ringdown::synth
