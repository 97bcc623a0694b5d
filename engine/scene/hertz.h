// How long two elastic bodies touch in a blow: Hertz's law. [any thread]
//
// Bodies that meet with speed v press each other flat by Hertz's force F = 4/3 E* sqrt(R) d^1.5, and part after
//
//   T = 2.87 (m^2 / (R E*^2 v))^(1/5)                      (K. L. Johnson, Contact Mechanics, equation 11.24)
//
// with the effective mass m, the relative radius R and the contact modulus E* of the two. Heavy and soft bodies touch
// for long and sound dull; small and hard ones sound bright. The law is for smooth, round, elastic bodies: what yields
// or has flat faces touches for longer.
#pragma once

#include "engine/scene/solid.h"

namespace ringdown::scene {

struct Elastic {
  double young_pa = kDefaultYoung_pa;
  double poisson = kDefaultPoisson;
};

// 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b  [Pa]
double contact_modulus(const Elastic& a, const Elastic& b);

// What is round about a body where it is touched.
struct Curvature {
  enum Kind { sphere, edged, flat } kind = edged;
  double radius_m = 0;  // of the sphere, or of the rounded edges; without meaning when flat
};

// Two spheres: 1/R = 1/R_a + 1/R_b. A sphere meets faces of other shapes: its own radius. Otherwise the sharper edge of
// the two touches a face. [m]
double relative_radius(const Curvature& a, const Curvature& b);

// 1/m of a body as a blow along the unit `normal` at `arm_m` from its centre of mass feels it: 1/m plus what turning
// gives way, (r x n) . I^-1 (r x n). `to_world` turns the object frame, along which the inertia is, into that of the
// two vectors. [1/kg]
double inverse_effective_mass(const RigidMass& mass, const Matrix3& to_world, Vec3 arm_m, Vec3 normal);

// T above, from 1/m of both sides together [1/kg] and the speed of approach, > 0. [s]
double hertz_time(double inverse_mass, double radius_m, double modulus_pa, double approach_m_s);

}  // namespace ringdown::scene
