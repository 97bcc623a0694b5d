// Faces that meet: how much of their common patch bears, how long their impact lasts, and over which widths a lasting
// contact smooths what it travels over. After the reference model of KHR_audio_rigid_bodies, appendix B. [any thread]
//
// Rough surfaces bear where they touch, at a pressure p = E* g / 2 that depends on neither load nor area, with g the
// rms gradient of the heights. Of a patch A0 under the load N the part A = A0 erf(sqrt(pi) N / (2 A0 p)) touches
// (Pastewka and Robbins 2016). One scale up, with the waviness in place of g, the law says how much of a patch that two
// flat faces share bears at all.
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/contact/contact_side.h"

#include <span>

namespace ringdown::scene {

// The area that bears; `gradient` is dimensionless, 0 for flat faces, which bear everywhere. [m^2]
double bearing_area(double area_m2, double load_n, double modulus_pa, double gradient);

// The duration of an impact of two flat faces: pi sqrt(m / k) with the stiffness k = 2 E* sqrt(A / pi) of a flat punch,
// whatever the speed, and A the area that bears the largest load v sqrt(m k), which follows by iteration where
// `waviness` is not 0. [s]
double face_impact_time(double inverse_mass, double modulus_pa, double area_m2, double waviness, double approach_m_s);

// The area of the convex hull of points, seen along the unit `normal`. Empty for fewer than three. [m^2]
double patch_area(std::span<const Vec3> points_m, Vec3 normal);

// The rms gradient of the waviness of both surfaces together.
double waviness_of(const FrictionSurface& a, const FrictionSurface& b);

// The widths over which profiles and mesoscale relief are smoothed under a load: the width of the real area of contact,
// and the diameter of Hertz's patch that confines it. 0 where neither surface has a relief. [m]
struct FilterWidths {
  double finish_m = 0, relief_m = 0;
};
FilterWidths filter_widths(const ContactSide& a, const ContactSide& b, double load_n);

// How deep a load presses two surfaces together, in parts that add: Hertz's, or that of the spring on which their
// masses swing for the contact time that a surface gives; and that of roughness, whose stiffness is the load over 0.4
// of its rms height (Persson, Phys. Rev. Lett. 99, 125502, 2007). The stiffness of all is 1.5 times the load over the
// depth.
double pressed_depth(const ContactSide& a, const ContactSide& b, double inverse_mass, double load_n);  // [m]

}  // namespace ringdown::scene
