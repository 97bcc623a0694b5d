// Levels and decays of modes as a bank plays them. [any]
//
// A bank keeps of a mode's phase no more than the sign, so that modes which overlap and partly cancel each other in the
// recording do not do so in the bank: it would be too loud by up to 20 dB there, and ring too long. Such modes are
// given other levels and decays, with which they are as loud as the recording in cells of a third of an octave by 10
// ms.
#pragma once

#include "engine/fit/burst.h"
#include "engine/fit/sinusoids.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

// The modes as as_played() (burst.h) has them where that is near the recording already. `recording`: from its beginning
// to where its sound ends; `onset`: the sample at which modes begin. Never further from the recording than as_played().
std::vector<Mode> settle(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                         std::span<const Mode> modes);

// The parts of a recording that a bank keeps: settled modes, and a burst of noise for the rest.
struct Kept {
  std::vector<Mode> modes;
  Burst burst;
  std::vector<Mode> noise;   // the burst's modes
  double distance_db = NAN;  // of all that from the recording (band_powers.h)
  double sure_db = NAN;      // the same as loud as it is played, in sure cells alone: without single cells of noise
};

// As settle(), then a burst unless there should be none, and short modes once more beside it. A second or two.
Kept keep(std::span<const double> recording, double sample_rate_hz, std::size_t onset, std::span<const Mode> modes,
          bool with_burst);

}  // namespace ringdown::fit
