// Contacts between faces: how much of their common patch bears, how long their impact lasts, and over which widths a
// lasting contact smooths the relief. After the reference model of KHR_audio_rigid_bodies, appendix B. [any thread]
//
// Rough surfaces bear where they touch, at a pressure p = E* g / 2 that depends on neither load nor area, with g the
// rms gradient of the heights. Of a patch A0 under the load N the part A = A0 erf(sqrt(pi) N / (2 A0 p)) touches
// (Pastewka and Robbins 2016). At the next larger scale, with the waviness in place of g, this law gives the bearing
// part of a patch that two flat faces share.
#pragma once

#include "engine/base/vec3.h"
#include "engine/scene/contact/contact_side.h"

#include <span>

namespace ringdown::scene {

// Returns the area that bears. `gradient` is dimensionless; it is 0 for flat faces, which bear everywhere. [m^2]
double bearing_area(double area_m2, double load_n, double modulus_pa, double gradient);

// Returns the duration of an impact of two flat faces: pi sqrt(m / k), at any speed, with the stiffness k = 2 E* sqrt(A
// / pi) of a flat punch. A is the area that bears the largest load, v sqrt(m k); it is found by iteration if `waviness`
// is not 0. [s]
double face_impact_time(double inverse_mass, double modulus_pa, double area_m2, double waviness, double approach_m_s);

// Returns the area of the convex hull of the points, projected along the unit `normal`; 0 for fewer than three points.
// [m^2]
double patch_area(std::span<const Vec3> points_m, Vec3 normal);

// Returns the rms gradient of the waviness of both surfaces together.
double waviness_of(const FrictionSurface& a, const FrictionSurface& b);

// Widths over which profiles and mesoscale relief are smoothed under a load: the width of the real area of contact, and
// the diameter of Hertz's patch that confines that area. 0 if neither surface has a relief. [m]
struct FilterWidths {
  double finish_m = 0, relief_m = 0;
};
FilterWidths filter_widths(const ContactSide& a, const ContactSide& b, double load_n);

// Returns how deep a load presses two surfaces together, as a sum of two parts. The first is Hertz's depth, or, if a
// surface gives a contact time, that of the spring on which their masses swing for that time. The second is that of
// roughness, whose stiffness is the load over 0.4 of its rms height (Persson, Phys. Rev. Lett. 99, 125502, 2007). The
// total stiffness is 1.5 times the load over the depth.
double pressed_depth(const ContactSide& a, const ContactSide& b, double inverse_mass, double load_n);  // [m]

}  // namespace ringdown::scene
