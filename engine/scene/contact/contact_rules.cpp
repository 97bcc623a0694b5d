#include "engine/scene/contact/contact_rules.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

std::optional<double> longer(std::optional<double> a, std::optional<double> b) {
  return a && b ? std::max(a, b) : a ? a : b;
}

double shortest(const synth::Texture& t) {
  return t.shortest_m > 0 ? t.shortest_m : std::ldexp(t.correlation_m, 1 - static_cast<int>(t.octaves()));
}

synth::Texture combine(const synth::Texture& a, const synth::Texture& b) {
  const double variance_a = a.roughness_m * a.roughness_m, variance_b = b.roughness_m * b.roughness_m;
  const double sum = variance_a + variance_b;
  const double share = sum > 0 ? variance_a / sum : 0.5;
  const auto mean = [share](double of_a, double of_b) { return share * of_a + (1 - share) * of_b; };
  synth::Texture both{std::sqrt(sum), mean(a.correlation_m, b.correlation_m), mean(a.spectral_slope, b.spectral_slope)};
  if (a.shortest_m > 0 || b.shortest_m > 0) both.shortest_m = mean(shortest(a), shortest(b));
  return both;
}

double combine(Combine way, double a, double b) {
  switch (way) {
    case Combine::average:
      return 0.5 * (a + b);
    case Combine::minimum:
      return std::min(a, b);
    case Combine::maximum:
      return std::max(a, b);
    case Combine::multiply:
      return a * b;
    case Combine::geometric_mean:
      break;
  }
  return std::sqrt(a * b);
}

}  // namespace

SoftConstraint soft_constraint(double spring_n_m, double damper_ns_m, double step_s) {
  const double both = step_s * spring_n_m + damper_ns_m;
  return {step_s * spring_n_m / both, 1 / both};
}

double bounce_threshold(const SceneDescription& scene) {
  return std::max(scene.contact.bounce_threshold_m_s, 1.5 * length(scene.gravity_m_s2) * scene.step_s);
}

SurfacePair combine(const FrictionSurface& a, const FrictionSurface& b) {
  const Combine friction = std::min(a.friction_combine, b.friction_combine);
  return {combine(std::min(a.restitution_combine, b.restitution_combine), a.restitution, b.restitution),
          combine(friction, a.friction, b.friction),
          combine(friction, a.sliding_friction.value_or(a.friction), b.sliding_friction.value_or(b.friction)),
          std::sqrt(a.rolling_m * b.rolling_m),
          longer(a.contact_time_s, b.contact_time_s),
          combine(a.texture, b.texture)};
}

// The solver's velocities are those of half a step before or after a position, hence half_m_s. Conservation of energy
// over the overlap `depth_m` gives the speed at which the body touched the surface, v_touch^2 = v^2 - 2 g d.
// Restitution then gives the speed at which the body should leave the surface, and energy again the speed needed at
// depth d.
Landing corrected_landing(const Fall& fall) {
  const double half_m_s = 0.5 * fall.fall_m_s2 * fall.part_s;
  const double now = fall.approach_m_s + half_m_s, gained = 2 * fall.fall_m_s2 * fall.depth_m;
  const double touched = std::sqrt(std::max(now * now - gained, 0.0));
  const double leaves = fall.restitution * touched;
  const double rises = std::sqrt(std::max(leaves * leaves + gained, 0.0)) - half_m_s;
  const double after =
      leaves >= fall.threshold_m_s ? std::clamp(rises, 0.0, fall.approach_m_s) : fall.restitution * fall.approach_m_s;
  return {after / fall.approach_m_s, touched,
          (touched + leaves) / (fall.approach_m_s + std::max(after, fall.pushed_m_s) + 2 * half_m_s)};
}

}  // namespace ringdown::scene
