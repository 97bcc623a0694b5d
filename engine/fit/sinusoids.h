// Sums damped sinusoids, and finds their amplitudes in a sound by linear least squares over all of them together, so
// that modes that overlap in time and frequency share the sound that both could explain. [any]
#pragma once

#include <span>
#include <vector>

namespace ringdown::fit {

// One mode of a recording: a damped sinusoid, with the errors of its estimate.
struct Mode {
  double frequency_hz = 0;  // damped
  double decay_per_s = 0;
  double amplitude = 0;  // at the onset, in units of the samples
  double phase_rad = 0;  // phase of the sine at the onset, in (-pi, pi]
  // Standard errors, from the noise of the mode's band.
  double frequency_error_hz = 0;
  double decay_error_per_s = 0;
  double amplitude_error = 0;  // relative
};

// Sets amplitude and phase of every mode, at the time of the first sample. Cost: samples * modes.
void fit_amplitudes(std::span<const double> samples, double sample_rate_hz, std::span<Mode> modes);

// The sum of the modes. The first sample lies `offset_s` after the time to which amplitudes and phases refer.
std::vector<double> synthesise(std::span<const Mode> modes, double sample_rate_hz, std::size_t samples,
                               double offset_s = 0);

// Changes amplitudes and phases to those `seconds` later (or earlier, if negative).
void move_time(std::span<Mode> modes, double seconds);

}  // namespace ringdown::fit
