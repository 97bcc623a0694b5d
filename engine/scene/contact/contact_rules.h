// Computes the numbers of a contact: its stiffness, the combined properties of two surfaces, and the bounce of a body
// that lands. Free of any physics engine. [any thread]
#pragma once

#include "engine/scene/description.h"

#include <optional>

namespace ringdown::scene {

// ODE's two parameters of a soft constraint.
struct SoftConstraint {
  double erp = 0;  // share of the penetration corrected in one step, 0 ... 1
  double cfm = 0;  // [m/(N s)] compliance: velocity error per unit of constraint force
};

// A spring k_p with a damper k_d, integrated implicitly over a step h (ODE manual 3.8.2; report 4.12 and 4.13):
//   ERP = h k_p / (h k_p + k_d),   CFM = 1 / (h k_p + k_d).
SoftConstraint soft_constraint(double spring_n_m, double damper_ns_m, double step_s);

// Returns the approach speed above which a contact bounces and strikes: the description's threshold, or 1.5 times the
// speed gained by falling for one step if that is larger, because a resting body may lose contact for one step. [m/s]
double bounce_threshold(const SceneDescription& scene);

// The properties of a contact between two surfaces.
struct SurfacePair {
  double restitution = 0, friction = 0, sliding_friction = 0;  // combined in the way that the surfaces name
  double rolling_m = 0;                                        // geometric mean
  std::optional<double> contact_time_s;                        // the longer of those given: the softer surface decides
  synth::Texture texture;                                      // variances add; the rest are means weighted by variance
};
SurfacePair combine(const FrictionSurface& a, const FrictionSurface& b);

// A body that falls onto a fixed surface and is first found inside it.
struct Fall {
  double restitution = 0;
  double approach_m_s = 0;   // along the normal, now
  double fall_m_s2 = 0;      // gravity along the normal, towards the surface
  double depth_m = 0;        // overlap now
  double part_s = 0;         // time step
  double threshold_m_s = 0;  // slower bodies do not bounce
  double pushed_m_s = 0;     // speed at which the overlap alone would be corrected
};

// A bounce corrected for the late detection of the contact. A body is stopped below the surface, after falling on for
// up to one time step, so its speed is too high, and the way back up costs speed again. Without the correction a
// rebound of 0.4 m/s would come out 7 % too slow at a step of 2 ms.
struct Landing {
  double bounce = 0;        // ratio of speeds for the solver, so that the body leaves the surface correctly
  double approach_m_s = 0;  // at the surface
  double share = 1;         // share of the solver's impulse due to the impact, without gravity since then
};
Landing corrected_landing(const Fall& fall);

}  // namespace ringdown::scene
