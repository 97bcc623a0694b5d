#include "engine/scene/contact/hertz.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

double compliance(const Elastic& solid) { return (1 - solid.poisson * solid.poisson) / solid.young_pa; }

}  // namespace

double contact_modulus(const Elastic& a, const Elastic& b) { return 1 / (compliance(a) + compliance(b)); }

double relative_radius(const Curvature& a, const Curvature& b) {
  if (a.kind == Curvature::sphere && b.kind == Curvature::sphere) return 1 / (1 / a.radius_m + 1 / b.radius_m);
  if (a.kind == Curvature::sphere || b.kind == Curvature::flat) return a.radius_m;
  if (b.kind == Curvature::sphere || a.kind == Curvature::flat) return b.radius_m;
  return std::min(a.radius_m, b.radius_m);
}

double inverse_effective_mass(const RigidMass& mass, const Matrix3& to_world, Vec3 arm_m, Vec3 normal) {
  const Vec3 turn = transpose(to_world) * cross(arm_m, normal);
  return 1 / mass.mass_kg + dot(turn, inverse(mass.inertia_kg_m2) * turn);
}

double hertz_time(double inverse_mass, double radius_m, double modulus_pa, double approach_m_s) {
  return 2.87 * std::pow(inverse_mass * inverse_mass * radius_m * modulus_pa * modulus_pa * approach_m_s, -0.2);
}

double hertz_stiffness(double mass_kg, double approach_m_s, double contact_time_s) {
  constexpr double kTimes = 2.94;  // contact time over the largest depth, times speed
  return 1.25 * mass_kg * approach_m_s * approach_m_s / std::pow(contact_time_s * approach_m_s / kTimes, 2.5);
}

}  // namespace ringdown::scene
