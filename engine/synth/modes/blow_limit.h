// Thin objects are not struck through: a blow that would bend one by more than kMaxThicknesses is made weaker, because
// the equation of nonlinear.h holds no further (docs/how/nonlinear.md).
#pragma once

#include "engine/base/realtime.h"

namespace ringdown::synth {

struct GlideMatrix;

inline constexpr double kMaxThicknesses = 3;
inline constexpr double kCrest = 1.7;  // of the sixteen lowest modes of a struck plate, in the full equations

// Returns the share of a blow that an object can take, 0 ... 1. `squares` has |z|^2 of its gliding modes before the
// blow, and `amplitudes` what the blow gives every column. The deflection is kCrest times the root of the sum of
// squares of each mode's largest one, at the pitch that the mode has then: stiffened modes move less far. What rings
// and the blow are taken to be unrelated. [audio]
double blow_limit(const GlideMatrix& matrix, const float* squares, const double* amplitudes) REALTIME;

}  // namespace ringdown::synth
