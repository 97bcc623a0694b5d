// How the tubes under an object are tuned. [any thread]
#pragma once

#include "engine/base/range.h"

namespace ringdown::modal {

inline constexpr Range kTubeDetune_cents{-1200, 1200}, kTubeOpening{0, 1};

struct TubeTuning {
  double detune_cents = 0;  // from the tuning as baked; tubes get shorter or longer
  double opening = 1;       // share of the mouth that is open
  friend bool operator==(const TubeTuning&, const TubeTuning&) = default;
};

}  // namespace ringdown::modal
