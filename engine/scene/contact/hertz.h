// Computes how long two elastic bodies touch in an impact, by Hertz's law. [any thread]
//
// Bodies that meet with the speed v deform each other by Hertz's force F = 4/3 E* sqrt(R) d^1.5, and part after
//
//   T = 2.87 (m^2 / (R E*^2 v))^(1/5)              (K. L. Johnson, Contact Mechanics, equation 11.24)
//
// with the effective mass m, the relative radius R and the contact modulus E* of the two. Heavy and soft bodies touch
// for long and sound dull; small and hard bodies sound bright. The law holds for smooth, round, elastic bodies; bodies
// that yield or have flat faces touch for longer.
#pragma once

#include "engine/scene/solid.h"

namespace ringdown::scene {

struct Elastic {
  double young_pa = kDefaultYoung_pa;
  double poisson = kDefaultPoisson;
};

// 1/E* = (1 - nu_a^2)/E_a + (1 - nu_b^2)/E_b [Pa]
double contact_modulus(const Elastic& a, const Elastic& b);

// The curvature of a body where it is touched.
struct Curvature {
  enum Kind { sphere, edged, flat } kind = edged;
  double radius_m = 0;  // radius of the sphere or of the rounded edges; not used if flat
};

// Returns the relative radius R. For two spheres, 1/R = 1/R_a + 1/R_b. A sphere is assumed to meet a face of any other
// shape, so R is the sphere's radius. For two other shapes, the sharper edge is assumed to meet a face. [m]
double relative_radius(const Curvature& a, const Curvature& b);

// Returns the inverse effective mass of a body against an impact along the unit `normal` at `arm_m` from its centre of
// mass: 1/m + (r x n) . I^-1 (r x n), where the second term is due to the body's turning. `to_world` rotates the object
// frame, in which the inertia is given, into the frame of the two vectors. [1/kg]
double inverse_effective_mass(const RigidMass& mass, const Matrix3& to_world, Vec3 arm_m, Vec3 normal);

// Returns the contact time T, from the sum of both inverse masses [1/kg] and the approach speed, > 0. [s]
double hertz_time(double inverse_mass, double radius_m, double modulus_pa, double approach_m_s);

// Returns the stiffness k of the spring F = k d^1.5 on which a mass that approaches with this speed bounces in the
// contact time, all > 0. By Hertz's law k = 4/3 E* sqrt(R). [N/m^1.5]
double hertz_stiffness(double mass_kg, double approach_m_s, double contact_time_s);

}  // namespace ringdown::scene
