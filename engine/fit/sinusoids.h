// Damped sinusoids summed, and their amplitudes found again in a sound: linear least squares over all of them together,
// so that modes that overlap in time and frequency share out what both could explain. [any]
#pragma once

#include <span>
#include <vector>

namespace ringdown::fit {

// One mode of a recording: a damped sinusoid, with the errors of its estimate.
struct Mode {
  double frequency_hz = 0;  // damped
  double decay_per_s = 0;
  double amplitude = 0;  // at the onset, in units of the samples
  double phase_rad = 0;  // of the sine, at the onset, in (-pi, pi]
  // Standard errors, as the noise of the mode's band gives them.
  double frequency_error_hz = 0;
  double decay_error_per_s = 0;
  double amplitude_error = 0;  // relative
};

// Sets amplitude and phase of every mode, meant at the first sample. Cost: samples * modes.
void fit_amplitudes(std::span<const double> samples, double sample_rate_hz, std::span<Mode> modes);

// The sum of the modes; `offset_s` is the first sample's time after where amplitudes and phases are meant.
std::vector<double> synthesise(std::span<const Mode> modes, double sample_rate_hz, std::size_t samples,
                               double offset_s = 0);

// Amplitudes and phases as they are `seconds` later (or, if below 0, earlier).
void move_time(std::span<Mode> modes, double seconds);

}  // namespace ringdown::fit
