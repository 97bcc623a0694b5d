// A material's loss factor eta, and Rayleigh's two terms that come nearest to it. [any thread]
//
// eta = 2 d / omega = alpha / omega + beta omega: of a Rayleigh-damped mode of undamped angular frequency omega. Tables
// and measurements give eta at some frequencies; a real material's seldom follows that curve, so a fit is good near the
// frequencies it was made for, and worst_error() says how good.
#pragma once

#include "engine/modal/damping.h"

#include <span>

namespace ringdown::modal {

struct LossFactor {
  double frequency_hz = 0;  // > 0
  double eta = 0;           // > 0
};

double loss_factor(RayleighDamping damping, double frequency_hz);

// The non-negative alpha and beta for which the sum of (fitted eta / eta - 1)^2 over the points is least: relative, as
// decay times are heard. Of points at one frequency only, beta alone. There must be a point.
RayleighDamping fit_rayleigh(std::span<const LossFactor> points);

// The largest |fitted eta / eta - 1| of any point.
double worst_error(RayleighDamping damping, std::span<const LossFactor> points);

}  // namespace ringdown::modal
