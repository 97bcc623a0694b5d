// Finds levels and decays for modes as a bank plays them. [any]
//
// A bank keeps only the sign of a mode's phase. Modes that overlap and partly cancel each other in the recording
// therefore do not cancel in the bank, where they would be too loud by up to 20 dB and ring too long. Such modes get
// other levels and decays, with which they are as loud as the recording in cells of a third of an octave by 10 ms.
#pragma once

#include "engine/fit/burst.h"
#include "engine/fit/sinusoids.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::fit {

// Settles the modes. Modes for which as_played() (burst.h) is already near the recording stay as as_played() returns
// them. The result is never further from the recording than as_played(). `recording` ends where its sound ends; modes
// begin at sample `onset`.
std::vector<Mode> settle(std::span<const double> recording, double sample_rate_hz, std::size_t onset,
                         std::span<const Mode> modes);

// The parts of a recording that a bank keeps: settled modes, and a burst of noise for the rest.
struct Kept {
  std::vector<Mode> modes;
  Burst burst;
  std::vector<Mode> noise;   // the burst's modes
  double distance_db = NAN;  // distance of modes and burst from the recording (band_powers.h)
  double sure_db = NAN;      // distance without a gain, over sure_cells() only
};

// Settles the modes, adds a burst if `with_burst`, and then adjusts short modes in the presence of the burst. Takes a
// second or two.
Kept keep(std::span<const double> recording, double sample_rate_hz, std::size_t onset, std::span<const Mode> modes,
          bool with_burst);

}  // namespace ringdown::fit
