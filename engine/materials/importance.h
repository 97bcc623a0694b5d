// Importance of a mode: its share of the object's sound, by which the modes in a bank are ordered. [any thread]
#pragma once

#include "engine/modal/damping.h"

namespace ringdown::bake {

// The A-weighting curve as an amplitude factor, 1 at 1 kHz (IEC 61672-1, appendix E).
double a_weighting(double frequency_hz);

// The envelope of the spectrum of a hard contact's pulse, tau = 0.3 ms: 1 / (1 + (2 f tau)^2), without its zeros.
double hard_contact(double frequency_hz);

// The integral over the first 0.2 s of exp(-2 d t) [s]: 0.2 s is the time over which loudness builds up (Zwicker &
// Fastl, Psychoacoustics, section 8.4).
double collected_s(double decay_per_s);

// Energy of the mode's sound as the ear collects it, up to a factor common to all modes of an object:
//
//   (pressure * rms shape * A(f) * hard_contact(f))^2 * collected_s(d)
//
// with the pressure that a modal velocity of 1 radiates (modal/loudness.h); the rms over the surface stands for a
// strike anywhere. A choice, used for ordering only: dropping a bank's last modes loses the least.
double importance(modal::DampedMode mode, double pressure_pa, double surface_rms);

}  // namespace ringdown::bake
