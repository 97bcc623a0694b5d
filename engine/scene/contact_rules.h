// When a contact sounds, and how stiff it is: the rules of the course report, free of any physics engine. [any thread]
#pragma once

#include "engine/scene/description.h"

#include <cstdint>
#include <map>
#include <utility>

namespace ringdown::scene {

// ODE's two constraint parameters.
struct SoftConstraint {
  double erp = 0;  // share of the penetration corrected in one step, 0 ... 1
  double cfm = 0;  // [m/(N s)] compliance: velocity error per unit of constraint force
};

// A spring k_p with a damper k_d, integrated implicitly over a step h (ODE manual 3.8.2; report 4.12 and 4.13):
//   ERP = h k_p / (h k_p + k_d),   CFM = 1 / (h k_p + k_d).
SoftConstraint soft_constraint(double spring_n_m, double damper_ns_m, double step_s);

// What a contact between two surfaces is made of.
Surface combine(const Surface& a, const Surface& b);

// Lets a pair of bodies sound once, then not again before `minimum_repeat_s` has passed. All contact points of one
// pair in one step sound together: they are one blow that superposes.
class RepeatFilter {
 public:
  explicit RepeatFilter(double minimum_repeat_s) : minimum_repeat_s_(minimum_repeat_s) {}

  // Whether the pair may sound at `time_s`. Order of the two does not matter; time never runs backwards.
  bool admit(std::uint32_t a, std::uint32_t b, double time_s);

  // Forgets pairs that are free to sound again anyway, so that the memory follows what is happening. Once a step.
  void forget_old(double time_s);

  [[nodiscard]] std::size_t remembered() const { return last_s_.size(); }

 private:
  double minimum_repeat_s_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> last_s_;
};

}  // namespace ringdown::scene
