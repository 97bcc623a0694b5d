// V(d) = k d^(alpha + 1) / (alpha + 1) is the spring's energy and P = sqrt(2 V).
//
// The exact mean force over a step is (V(d + x) - V(d)) / x for a change x, and x follows from x = free - Z (mean force
// + r x). The left side minus the right is convex and rising for alpha >= 1, so Newton's steps from x = free come down
// to the root from one side; three of them, or one from the tangent at d, leave an error that affects accuracy but not
// passivity. The line that is returned is a discrete gradient of psi^2 / 2: with g = (P(d + x) - P(d)) / x,
//
//   f = g psi + (g^2 / 2 + r) x',  psi' = psi + g x'   =>   f x' = (psi'^2 - psi^2) / 2 + r x'^2
//
// for any change x' that then happens. psi and P(d) agree up to a small error, which is only corrected downwards.
#include "engine/contact/impact.h"

#include <algorithm>
#include <cmath>

namespace ringdown::contact {
namespace {

double power(double depth, double exponent) REALTIME {
  if (depth <= 0) return 0;
  if (exponent == 1.5) return depth * std::sqrt(depth);
  if (exponent == 1) return depth;
  return std::pow(depth, exponent);
}
double force_at(const ImpactLaw& law, double depth) REALTIME { return law.stiffness * power(depth, law.exponent); }
double energy_at(const ImpactLaw& law, double depth) REALTIME {
  return depth > 0 ? force_at(law, depth) * depth / (law.exponent + 1) : 0.0;
}
double root_at(const ImpactLaw& law, double depth) REALTIME { return std::sqrt(2 * energy_at(law, depth)); }

// ((1 + t)^1.25 - 1) / t to 1e-13 for |t| <= kSmall: the binomial series.
constexpr double kSmall = 0.02;
double secant_of_small(double t) REALTIME {
  return 1.25 +
         t * (0.15625 + t * (-0.0390625 + t * (0.01708984375 + t * (-0.0093994140625 + t * (0.005874633789062 +
                                                                                            t * -0.003986358642578)))));
}

}  // namespace

Impact::Step Impact::foresee(const ImpactLaw& law, double free_m, double compliance_m_n, double step_s) REALTIME {
  constexpr double kTiny = 1e-4;  // of the depth: a change below it makes differences of energies inexact
  const double d = depth_m_, share = 1 / (law.exponent + 1);
  touches_ = d > 0 || d + free_m > 0;
  secant_ = 0;
  if (!touches_) {
    psi_ = 0;
    return {};
  }
  if (d <= 0) {
    constexpr double kSlowest_m_s = 1e-3;
    const double speed = std::max(free_m / step_s, kSlowest_m_s);
    damping_s_m_ = law.damping_s_m + (law.bounce < 1 ? 1.5 * (1 - law.bounce) / (law.bounce * speed) : 0.0);
  }
  const double loss = damping_s_m_ > 0 ? damping_s_m_ * force_at(law, d + 0.5 * free_m) / step_s : 0.0;
  const double force = force_at(law, d), energy = d > 0 ? share * force * d : 0.0;
  // Inside, the tangent at d is as good a beginning as two steps from `free_m`.
  double x = free_m;
  int steps = 3;
  if (d > 0) {
    const double per_m = 1 / d, straight = force * per_m;
    x = (free_m - compliance_m_n * force) / (1 + compliance_m_n * (0.5 * law.exponent * straight + loss));
    if (law.exponent == 1.5 && std::abs(x) <= kSmall * d) {
      return foresee_small(straight, x * per_m, free_m, compliance_m_n, loss);
    }
    steps = std::abs(x) < 0.5 * d ? 1 : 3;
  }
  for (int i = 0; i < steps; ++i) {
    double mean, slope;
    if (std::abs(x) > kTiny * std::max(d, d + x)) {
      const double end = force_at(law, d + x), inverse = 1 / x;
      mean = ((d + x > 0 ? share * end * (d + x) : 0.0) - energy) * inverse;
      slope = (end - mean) * inverse;
    } else {
      mean = force_at(law, d + 0.5 * x);
      slope = 0.5 * law.exponent * mean / std::max(d + 0.5 * x, 1e-300);
    }
    x -= (x - free_m + compliance_m_n * (mean + loss * x)) / (1 + compliance_m_n * (std::max(slope, 0.0) + loss));
  }
  const double root = std::sqrt(2 * energy);
  if (std::abs(x) > 1e-6 * std::max(d, d + x)) {
    secant_ = (root_at(law, d + x) - root) / x;
  } else {
    const double middle = d + 0.5 * x;
    secant_ = middle > 0 ? force_at(law, middle) / root_at(law, middle) : 0.0;
  }
  psi_ = std::min(psi_, root);
  return closed(free_m, compliance_m_n, loss);
}

// A change that is a small share of the depth: the force over the depth is straight, and the secant a series.
Impact::Step Impact::foresee_small(double straight_n_m, double share, double free_m, double compliance_m_n,
                                   double loss) REALTIME {
  const double root_per_m = std::sqrt(0.8 * straight_n_m);
  psi_ = std::min(psi_, root_per_m * depth_m_);
  secant_ = root_per_m * secant_of_small(share);
  return closed(free_m, compliance_m_n, loss);
}

Impact::Step Impact::closed(double free_m, double compliance_m_n, double loss) const REALTIME {
  const Line line{secant_ * psi_, 0.5 * secant_ * secant_ + loss};
  return {line, std::max(0.0, (line.at_rest + line.per_m * free_m) / (1 + line.per_m * compliance_m_n)), true};
}

void Impact::advance(const ImpactLaw& law, double change_m, bool released) REALTIME {
  if (touches_ && released) psi_ = std::min(psi_, root_at(law, depth_m_ + change_m));
  if (touches_ && !released) psi_ += secant_ * change_m;
  depth_m_ += change_m;
}

void Impact::shift(const ImpactLaw& law, double by_m) REALTIME {
  depth_m_ += by_m;
  psi_ = std::min(psi_, root_at(law, depth_m_));
}

}  // namespace ringdown::contact
