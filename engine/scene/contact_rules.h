// How stiff a contact is, and what two surfaces make of it; free of any physics engine. [any thread]
#pragma once

#include "engine/scene/description.h"

#include <optional>

namespace ringdown::scene {

// ODE's two constraint parameters.
struct SoftConstraint {
  double erp = 0;  // share of the penetration corrected in one step, 0 ... 1
  double cfm = 0;  // [m/(N s)] compliance: velocity error per unit of constraint force
};

// A spring k_p with a damper k_d, integrated implicitly over a step h (ODE manual 3.8.2; report 4.12 and 4.13):
//   ERP = h k_p / (h k_p + k_d),   CFM = 1 / (h k_p + k_d).
SoftConstraint soft_constraint(double spring_n_m, double damper_ns_m, double step_s);

// Faster contacts bounce and strike, slower ones do not: the description's threshold, or one and a half times the speed
// that a fall of one step gives, if that is more. What rests may lose touch for a step. [m/s]
double bounce_threshold(const SceneDescription& scene);

// What a contact between two surfaces is made of.
struct SurfacePair {
  double restitution = 0, friction = 0, rolling_m = 0;  // geometric means
  std::optional<double> contact_time_s;                 // the longer of those given: the softer of the two decides
  synth::Texture texture;                               // variances add; the rest is their mean, weighted by variance
};
SurfacePair combine(const Surface& a, const Surface& b);

}  // namespace ringdown::scene
