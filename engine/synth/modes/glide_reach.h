// The detuning of modes by a gliding mode, for the pitches of a chunk and for the limit of a blow. [audio]
#pragma once

#include "engine/base/realtime.h"
#include "engine/synth/modes/glide.h"

#include <algorithm>
#include <cstddef>

namespace ringdown::synth {

// The most that mode l detunes any mode at |z_l|^2 = `square`, relative. It is kept below a million, where pitches have
// long ceased to move, so that sums over all modes stay numbers whatever a bank holds. What is not a number counts as
// that million.
[[nodiscard]] inline float reached(const GlideMatrix& matrix, std::size_t l, float square) REALTIME {
  return std::min(1e6F, matrix.reach[l] * square);
}

}  // namespace ringdown::synth
