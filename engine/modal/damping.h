// Relates a mode's frequency to its decay, and fits Rayleigh's two constants to a material's loss factors. This is the
// only header that converts Hz to rad/s.
//
// A mode of the undamped problem K phi = lambda M phi, with Rayleigh damping C = alpha M + beta K, moves as
//   q(t) = exp(-d t) sin(omega_d t),   d = (alpha + beta lambda) / 2 [1/s],   omega_d = sqrt(lambda - d^2) [rad/s].
// Source: any text on modal analysis, e.g. Shabana, Theory of Vibration, section 5.6. docs/how/physics.md derives it.
#pragma once

#include "engine/base/realtime.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace ringdown::modal {

// Rayleigh damping: alpha [1/s] weighs the mass matrix, beta [s] the stiffness matrix.
struct RayleighDamping {
  double alpha_per_s = 0;
  double beta_s = 0;
  friend bool operator==(const RayleighDamping&, const RayleighDamping&) = default;
};

// A damped sinusoid exp(-decay t) sin(2 pi frequency t).
struct DampedMode {
  double frequency_hz = 0;  // damped; 0 when the mode is critically or over-damped and has no pitch
  double decay_per_s = 0;   // amplitude falls by 1/e in 1/decay seconds
};

constexpr double hz_to_rad_per_s(double frequency_hz) REALTIME { return 2 * std::numbers::pi * frequency_hz; }
constexpr double rad_per_s_to_hz(double omega_rad_s) REALTIME { return omega_rad_s / (2 * std::numbers::pi); }

// Eigenvalue lambda [rad^2/s^2] -> the mode as heard.
inline DampedMode damp(double lambda, RayleighDamping damping) {
  const double decay = 0.5 * (damping.alpha_per_s + damping.beta_s * lambda);
  const double omega_squared = lambda - decay * decay;
  return {omega_squared > 0 ? rad_per_s_to_hz(std::sqrt(omega_squared)) : 0.0, decay};
}

// The eigenvalue a damped mode came from: lambda = omega_d^2 + d^2.
inline double undamped_lambda(DampedMode mode) {
  const double omega = hz_to_rad_per_s(mode.frequency_hz);
  return omega * omega + mode.decay_per_s * mode.decay_per_s;
}

// Returns the largest lambda whose mode may still lie below band_high_hz: the smaller root of
// lambda - ((alpha + beta lambda) / 2)^2 = (2 pi f)^2. If there is no root, returns the lambda of the highest possible
// pitch, at which the decay is 1 / beta. Beyond it, stiffness damping lowers the pitch again; such modes lose 55 dB or
// more in a cycle and are not searched for.
inline double highest_lambda_in_band(double band_high_hz, RayleighDamping damping) {
  const double omega = hz_to_rad_per_s(band_high_hz), alpha = damping.alpha_per_s, beta = damping.beta_s;
  if (beta <= 0) return omega * omega + alpha * alpha / 4;
  // (beta^2/4) lambda^2 - (1 - alpha beta/2) lambda + omega^2 + alpha^2/4 = 0; smaller root without
  // cancellation.
  const double half = (1 - alpha * beta / 2) / 2, last = omega * omega + alpha * alpha / 4;
  const double discriminant = half * half - beta * beta / 4 * last;
  if (half > 0 && discriminant > 0) return last / (half + std::sqrt(discriminant));
  return std::max(half * 4 / (beta * beta), 0.0);
}

// Seconds until the amplitude has fallen by 60 dB: ln(1000) / d.
inline double t60_s(double decay_per_s) { return std::log(1000.0) / decay_per_s; }

// Displacement of one mode at time t after a unit impulse, whatever the damping: under-, critically and over-damped,
// all without cancellation. Reference formula for tests and tables; the mixer never calls it.
inline double impulse_response(double lambda, RayleighDamping damping, double t_s) {
  const double decay = 0.5 * (damping.alpha_per_s + damping.beta_s * lambda);
  const double discriminant = lambda - decay * decay;
  const double x = std::sqrt(std::abs(discriminant)) * t_s;
  if (x < 1e-8) return t_s * std::exp(-decay * t_s);
  if (discriminant > 0) return t_s * std::exp(-decay * t_s) * std::sin(x) / x;
  // exp(-d t) sinh(x)/x = (exp(x - d t) - exp(-x - d t)) / 2x, with x <= d t so that nothing overflows. x - d t is
  // rewritten as -lambda t^2 / (x + d t): the roots of a heavily over-damped mode differ by orders of magnitude.
  const double slow = -lambda * t_s * t_s / (x + decay * t_s);
  return t_s * std::exp(slow) * -std::expm1(-2 * x) / (2 * x);
}

// A material's loss factor eta at one frequency.
//
// A Rayleigh-damped mode of undamped angular frequency omega has eta = 2 d / omega = alpha / omega + beta omega. Tables
// and measurements give eta at some frequencies. Real materials seldom follow the Rayleigh curve, so a fit is good only
// near the frequencies it was made for.

struct LossFactor {
  double frequency_hz = 0;  // > 0
  double eta = 0;           // > 0
};

double loss_factor(RayleighDamping damping, double frequency_hz);

// Returns the non-negative alpha and beta that minimise the sum of (fitted eta / eta - 1)^2 over the points. Errors are
// relative because decay times are heard relatively. If all points have one frequency, only beta is fitted. There must
// be a point.
RayleighDamping fit_rayleigh(std::span<const LossFactor> points);

}  // namespace ringdown::modal
