// The modes of a struck object, from a recording of one blow.
//
// The sound after the blow is taken for a sum of damped sinusoids in noise,
//
//   x(t) = sum over modes of A exp(-d t) sin(2 pi f t + phase),   t from the onset [s],
//
// and cut into bands narrow enough that a few hundred samples of each hold all there is to know (subband.h). In each,
// ESPRIT finds poles, which least squares makes as good as the noise allows; those that the noise of the band could
// have made are dropped (poles.h). Long modes are found first, over the whole recording; then, in what is left, shorter
// ones over its first quarter, sixteenth and so on, and those that die within a few cycles one by one (pursuit.h). At
// last all amplitudes are fitted together (sinusoids.h). What no mode explains may be kept as a burst (burst.h).
// [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/fit/sinusoids.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ringdown::fit {

struct Options {
  double low_hz = 20, high_hz = 20000;  // where modes are looked for; the top is at most 0.98 of half the sample rate
  double floor_db = 80;                 // modes whose amplitude lies further below the loudest's are dropped
  std::size_t max_modes = 1000;         // those of most energy stay
  std::optional<double> from_s;         // where the blow is; otherwise it is found
  int threads = 0;                      // 0: one for each processor
};

struct Fit {
  std::vector<Mode> modes;  // by frequency
  double onset_s = 0;       // of the recording; where amplitudes and phases are meant
  double start_s = 0;       // what was looked at: from here, after the onset where the beginning is clipped,
  double end_s = 0;         // to here, where the sound is lost in noise, the next blow comes, or kMaxLength_s are over
  std::size_t clipped = 0;  // samples that stand at full scale
  double explained = 0;     // 1 - energy of what the modes leave over that of the sound, from start to end
  double of_blow = 0;       // the same, of what the sound has beyond the noise before the blow, where that is known
};

inline constexpr double kMaxLength_s = 8;     // of the sound that is looked at
inline constexpr double kMinLength_s = 0.05;  // shorter recordings are refused
inline constexpr double kMinRate_hz = 8000;   // of samples
inline constexpr double kMaxRate_hz = 768000;
inline constexpr std::size_t kMaxModes = 4000;  // of Options::max_modes

// `samples`: one channel. No modes at all where there is nothing but noise. Fails when it is too short, a sample is no
// number, or the options make no sense. About ten seconds for eight of sound, on one processor.
Result<Fit> fit_modes(std::span<const double> samples, double sample_rate_hz, const Options& options = {});

}  // namespace ringdown::fit
