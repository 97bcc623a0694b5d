// Rolling resistance: a torque on the two bodies of a contact, against their turning over each other. ODE has its own,
// whose equations have no solution at times: its solver then gives up. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode_item.h"
#include "engine/scene/simulation.h"

#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

// How hard the pairs that touched pressed on each other in one part of a step.
class Loads {
 public:
  void note(std::span<const Touch> touches, double part_s);
  [[nodiscard]] double of_n(BodyId one, BodyId two) const;  // 0 of those that did not touch

 private:
  struct Load {
    std::uint64_t pair = 0;
    double force_n = 0;
  };
  std::vector<Load> loads_;  // by their pairs
};

// Adds the torque for the next `part_s`: `most_nm`, or less if that stops the turning or holds `body` on its slope.
// It never turns what turns one way the other way. `point_m` and `normal` are of the contact, world axes.
void resist_rolling(Item& body, Item& other, Vec3 point_m, Vec3 normal, double most_nm, Vec3 gravity_m_s2,
                    double part_s);

}  // namespace ringdown::scene
