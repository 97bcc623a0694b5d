#include "engine/modal/damping.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace ringdown::modal {

double loss_factor(RayleighDamping damping, double frequency_hz) {
  const double omega = hz_to_rad_per_s(frequency_hz);
  return damping.alpha_per_s / omega + damping.beta_s * omega;
}

// Linear least squares of relative errors: for each measured loss factor eta, (alpha / omega + beta omega) / eta should
// be 1. A passive material has no negative constant: if the best alpha or beta is negative, that one is set to 0 and
// only its partner is fitted.
RayleighDamping fit_rayleigh(std::span<const LossFactor> points) {
  assert(!points.empty());
  // With a = 1 / (omega eta) and b = omega / eta, each point asks for alpha a + beta b = 1.
  double aa = 0, ab = 0, bb = 0, a1 = 0, b1 = 0;
  for (const LossFactor& point : points) {
    const double omega = hz_to_rad_per_s(point.frequency_hz), a = 1 / (omega * point.eta), b = omega / point.eta;
    aa += a * a;
    ab += a * b;
    bb += b * b;
    a1 += a;
    b1 += b;
  }
  constexpr double kDistinct = 1e-9;  // squared sine of the angle between the columns
  const double determinant = aa * bb - ab * ab;
  if (determinant <= kDistinct * aa * bb) return {.beta_s = b1 / bb};
  const RayleighDamping both{(bb * a1 - ab * b1) / determinant, (aa * b1 - ab * a1) / determinant};
  if (both.alpha_per_s < 0) return {.beta_s = b1 / bb};
  if (both.beta_s < 0) return {.alpha_per_s = a1 / aa};
  return both;
}

}  // namespace ringdown::modal
