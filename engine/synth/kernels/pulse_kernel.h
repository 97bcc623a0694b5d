// Shapes the amplitudes of a blow by the spectrum of its pulse. [audio]
#pragma once

#include "engine/base/realtime.h"

#include <cstddef>

namespace ringdown::synth {

// Multiplies each of `count` amplitudes by the spectrum of a half-sine pulse (modal::pulse_spectrum) at the mode's
// frequency, to 1e-15, and returns the sum of the squares of the results. The pulse lasts `contact_frames`; `omega` is
// in radians per frame, >= 0; `count` is a multiple of kModePadding, and both arrays are 64-byte aligned.
double shape_by_pulse(const double* omega, std::size_t count, double contact_frames, double* amplitudes) REALTIME;

}  // namespace ringdown::synth
