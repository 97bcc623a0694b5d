// Limits that the nonlinear terms of a body cannot exceed. A bank with larger ones is refused when it is read. [worker]
//
// - Thickness: from a few atoms to a thousand metres.
// - Stretching: a body that is bent by its own thickness stretches about as hard as it bends. With a_i the amplitude
//   that moves some sample point of mode i by a thickness, the root of the sum over k of (H^k_ij)^2, times a_i a_j, is
//   0.44 to 0.65 times the root of omega_i a_i omega_j a_j for the stiffest pair of modes of our presets. The limit is
//   far above, because the sample points need not show where a mode moves most.
// - Curving: g_ki is the product of a mode's linear strain, whose energy is omega_i^2 at an amplitude of 1, with one of
//   a family of fields that are orthonormal in energy. So the sum over k of g_ki^2 is at most omega_i^2 (Bessel's
//   inequality); our curved presets have at most 0.84 omega_i^2.
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"

namespace ringdown::modal {

inline constexpr double kMinThickness_m = 1e-9, kMaxThickness_m = 1e3;
inline constexpr double kMaxStretching = 1000;  // ratio of stretching to bending
inline constexpr double kMaxCurving = 2;        // the root of the sum of g_ki^2, over omega_i

// Checks the `terms` of the bank's modes against its frequencies, decays and shapes. A refusal begins with `name`, as
// in "bell.glb: nonlinear".
Result<void> check(const NonlinearTerms& terms, const Bank& bank, const std::string& name);

}  // namespace ringdown::modal
