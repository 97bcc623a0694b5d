// Levels and decays of modes as a bank plays them. [any]
//
// A bank keeps of a mode's phase no more than the sign, so that modes which overlap and partly cancel each other in the
// recording do not do so in the bank: it would be too loud by up to 20 dB there, and ring too long. Such modes are
// given other levels and decays, with which they are as loud as the recording in cells of a third of an octave by 10
// ms.
#pragma once

#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

// As as_played(burst.h) has them where that is near the recording already. `recording`: from its beginning to where its
// sound ends; `onset`: the sample at which modes begin. Never further from the recording than as_played().
std::vector<Mode> settle(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                         std::span<const Mode> modes);

}  // namespace ringdown::fit
