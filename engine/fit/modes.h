// Finds the modes of a struck object in a recording of one blow. [worker]
//
// The sound after the blow is modelled as a sum of damped sinusoids in noise,
//
//   x(t) = sum over modes of A exp(-d t) sin(2 pi f t + phase),   t from the onset [s],
//
// and cut into bands narrow enough that a few hundred samples of each hold all its information (subband.h). In each
// band, ESPRIT finds poles, least squares refines them as far as the noise allows, and those that the noise of the band
// could have made are dropped (poles.h). Long modes are found first, over the whole recording. Shorter ones are then
// found in the remaining sound, over its first quarter, sixteenth and so on, and those that die within a few cycles one
// by one (pursuit.h). At last all amplitudes are fitted together (sinusoids.h). The sound that no mode explains may be
// kept as a burst (burst.h).
#pragma once

#include "engine/base/result.h"
#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::fit {

struct Options {
  double low_hz = 20, high_hz = 20000;  // range of the search; the top is at most 0.98 of half the sample rate
  double floor_db = 80;                 // modes with amplitudes further below the loudest are dropped
  // Bands whose peak lies further below the loudest band's are not searched; empty: those below the floor's modes.
  std::optional<double> quietest_band_db = {};
  std::size_t max_modes = 1000;  // the modes of most energy stay
  std::optional<double> from_s;  // time of the blow; empty: it is found
  int threads = 0;               // 0: one per processor
};

struct Fit {
  std::vector<Mode> modes;  // sorted by frequency
  double onset_s = 0;       // onset in the recording; amplitudes and phases refer to it
  double start_s = 0;       // beginning of the analysed part; after the onset if the beginning is clipped
  double end_s = 0;         // its end: the sound is lost in noise, the next blow comes, or kMaxLength_s are over
  std::size_t clipped = 0;  // number of samples at full scale
  double explained = 0;     // 1 - energy of the remainder over that of the sound, from start to end
  double of_blow = 0;       // as `explained`, without the noise measured before the blow if that is known
};

inline constexpr double kMaxLength_s = 8;     // longest part of the sound that is analysed
inline constexpr double kMinLength_s = 0.05;  // shorter recordings are refused
inline constexpr double kMinRate_hz = 8000;   // limits of the sample rate
inline constexpr double kMaxRate_hz = 768000;
inline constexpr std::size_t kMaxModes = 4000;  // limit of Options::max_modes

// Fits the modes of one channel of samples. Finds no modes in pure noise. Fails when the recording is too short, a
// sample is not a number, or the options are invalid. Takes about ten seconds for eight seconds of sound, on one
// processor.
Result<Fit> fit_modes(std::span<const double> samples, double sample_rate_hz, const Options& options = {});

}  // namespace ringdown::fit
