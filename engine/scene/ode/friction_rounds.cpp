#include "engine/scene/ode/friction_rounds.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::scene {
namespace {

// An island gives up if this many rounds in succession change its bounds by the same share, to kStuck. Heaps of pieces,
// in which loads can be shared out in many ways, get stuck at some thousandths, and no later round has been seen to
// agree then.
constexpr int kMaxStuckRounds = 3;
constexpr double kStuck = 0.01;

}  // namespace

void FrictionRounds::meet(std::size_t contact, std::size_t island, double asked_n) {
  Island& at = islands_[island];
  ++at.contacts;
  at.largest_n = std::max(at.largest_n, asked_n);
  at.change_n = std::max(at.change_n, bounds_[contact].meet(asked_n));
}

void FrictionRounds::end_round() {
  for (Island& island : islands_) {
    if (std::exchange(island.contacts, 0) == 0) continue;
    end_round(island);
    island.largest_n = island.change_n = 0;
  }
}

void FrictionRounds::end_round(Island& island) const {
  island.ended = island.gives_up;
  if (island.ended || failed_) {
    island.gives_up = true;
    return;
  }
  const bool first = island.rounds++ == 0;  // there were no bounds
  const double change = first ? 1 : island.change_n / std::max(island.largest_n, 1e-30);
  island.ended = change < kFrictionAgrees;
  island.stuck = std::abs(change - island.last) < kStuck * change ? island.stuck + 1 : 0;
  island.last = change;
  island.gives_up = island.rounds > kMaxFrictionRounds || island.stuck == kMaxStuckRounds;
}

bool FrictionRounds::give_up() {
  for (Island& island : islands_) island.gives_up = false;
  return !std::exchange(failed_, true);
}

}  // namespace ringdown::scene
