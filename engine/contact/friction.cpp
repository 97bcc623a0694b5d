// Backward Euler with a = alpha |v| / z_ss held over the step h gives z' = (z + h v) / (1 + a h), so
//
//   f = (sigma0 - sigma1 a) z / (1 + a h) + ((sigma0 - sigma1 a) h / (1 + a h) + sigma1 + sigma2) v,
//
// a straight line in v, which takes energy out for any a as long as sigma1 <= 4 sigma0 / a; a larger sigma1 is clipped.
// v follows from f, and a from v: one unknown, |v|. Faster sliding has weaker friction, so the repeated insertion |v|
// -> a -> f -> |v| approaches the nearest root from one side. If three speeds are possible, the bodies thus keep their
// present one, stuck or slipping. A secant speeds this up, within limits, and regula falsi (Illinois) ends it once the
// root has been passed.
#include "engine/contact/friction.h"

#include <algorithm>
#include <cmath>

namespace ringdown::contact {
namespace {

struct Trial {
  double rate = 0;
  Along at_rest{};
  double per_m = 0;
  Along slide_m{};
  double speed_m_s = 0;
};

double size_of(const Along& a) REALTIME { return a[1] == 0 ? std::abs(a[0]) : std::sqrt(a[0] * a[0] + a[1] * a[1]); }

}  // namespace

Friction::Step Friction::foresee(const FrictionLaw& law, double normal_n, const Along& free_m,
                                 const AlongCompliance& compliance_m_n, double step_s) REALTIME {
  const double max_n = law.static_coefficient * normal_n;
  constexpr double kMin_n = 1e-12;  // less would bend bristles by denormal numbers
  if (!(max_n > kMin_n)) {
    release();
    return {};
  }
  double bend = size_of(bend_);
  if (bend * law.bristle_n_m > max_n) {  // pressed less than before: the bristles let go of what they cannot hold
    const double keep = max_n / (law.bristle_n_m * bend);
    bend_ = {keep * bend_[0], keep * bend_[1]};
    bend *= keep;
  }
  const double stuck = law.stick_share * law.sliding_coefficient * normal_n / law.bristle_n_m;
  const double inv_step = 1 / step_s;

  // Damping is for what sticks: bristles that are swept along at once would push with sigma1 v, beyond any limit.
  const double swept = (bend > 0 ? slip_m_s_ : size_of(free_m) * inv_step) / law.stribeck_m_s;
  const double damping = law.bristle_ns_m / (1 + swept * swept);

  // The step with `rate` in place of a.
  const auto slide = [&](double rate) REALTIME {
    Trial trial{.rate = rate};
    const double sigma1 = rate > 0 ? std::min(damping, 4 * law.bristle_n_m / rate) : damping;
    const double held = (law.bristle_n_m - sigma1 * rate) / (1 + rate * step_s);
    trial.at_rest = {held * bend_[0], held * bend_[1]};
    trial.per_m = held + (sigma1 + law.viscous_ns_m) * inv_step;
    const AlongCompliance& z = compliance_m_n;
    const double rx = free_m[0] - z.xx * trial.at_rest[0] - z.xy * trial.at_rest[1];
    const double ry = free_m[1] - z.xy * trial.at_rest[0] - z.yy * trial.at_rest[1];
    const double xx = 1 + trial.per_m * z.xx, yy = 1 + trial.per_m * z.yy, xy = trial.per_m * z.xy;
    const double det = 1 / (xx * yy - xy * xy);
    trial.slide_m = {det * (yy * rx - xy * ry), det * (xx * ry - xy * rx)};
    trial.speed_m_s = inv_step * size_of(trial.slide_m);
    return trial;
  };
  Trial trial = slide(0);
  const double along = bend_[0] * trial.slide_m[0] + bend_[1] * trial.slide_m[1] < 0 ? -1 : 1;
  // Returns a for loaded bristles at a speed. Bristles are weakened by the slip speed of their roots, not by the speed
  // of their own bending: a slow creep holds until its limit.
  double slip = rate_ * bend;
  const auto rate_at = [&](double speed) REALTIME {
    const double ratio = slip / law.stribeck_m_s;
    const double g =
        normal_n * (law.sliding_coefficient + (law.static_coefficient - law.sliding_coefficient) / (1 + ratio * ratio));
    const double bent = g / law.bristle_n_m;
    const double end = std::abs(bend + along * speed * step_s);  // if no bristle slipped
    if (end <= stuck) return 0.0;
    const double t = end >= bent ? 1.0 : (end - stuck) / (bent - stuck);
    return t * t * (3 - 2 * t) * speed / bent;
  };

  const double end = size_of({bend_[0] + trial.slide_m[0], bend_[1] + trial.slide_m[1]});
  if (end > bend && end > stuck) {
    constexpr int kMaxTrials = 8;
    constexpr double kPrecision = 1e-7, kMaxHaste = 4;
    double x = std::max(slip_m_s_, trial.speed_m_s), other = 0, at_other = 0, before = 0, at_before = 0;
    bool bracketed = false;
    for (int i = 0; i < kMaxTrials; ++i) {
      trial = slide(rate_at(x));
      const double residual = trial.speed_m_s - x;
      slip =
          trial.rate * size_of({bend_[0] + trial.slide_m[0], bend_[1] + trial.slide_m[1]}) / (1 + trial.rate * step_s);
      if (std::abs(residual) <= kPrecision * (x + law.stribeck_m_s)) break;
      if (i > 0 && residual * at_before < 0) {  // the root lies between this trial and the last
        other = before;
        at_other = at_before;
        bracketed = true;
      } else if (bracketed) {
        at_other *= 0.5;
      }
      double next = x + residual;
      if (bracketed) {
        next = (x * at_other - other * residual) / (at_other - residual);
      } else if (i > 0) {
        const double slope = (residual - at_before) / (x - before);
        const double haste = slope < 0 ? std::clamp(-1 / slope, 1.0, kMaxHaste) : kMaxHaste;
        next = x + haste * residual;
      }
      before = x;
      at_before = residual;
      x = next;
    }
  }
  rate_ = trial.rate;
  rubs_ = true;
  return {trial.at_rest,
          trial.per_m,
          {trial.at_rest[0] + trial.per_m * trial.slide_m[0], trial.at_rest[1] + trial.per_m * trial.slide_m[1]}};
}

void Friction::advance(const Along& by_m, double step_s) REALTIME {
  if (!rubs_) return;
  const double keep = 1 / (1 + rate_ * step_s);
  bend_ = {keep * (bend_[0] + by_m[0]), keep * (bend_[1] + by_m[1])};
  slip_m_s_ = size_of(by_m) / step_s;
}

void Friction::stiffen(double by) REALTIME {
  const double keep = std::min(1 / by, 1 / std::sqrt(by));
  bend_ = {keep * bend_[0], keep * bend_[1]};
}

}  // namespace ringdown::contact
