// Rolling resistance: a torque on two bodies in contact against their relative spin. ODE has rolling friction of its
// own, but its equations are sometimes singular, and its solver then fails. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

#include <cstdint>
#include <span>
#include <vector>

namespace ringdown::scene {

// The normal forces between the pairs of bodies that touched in one part of a step.
class ContactLoads {
 public:
  void set(std::span<const ContactPoint> points, double part_s);
  [[nodiscard]] double of_n(BodyId one, BodyId two) const;  // 0 for a pair that did not touch

 private:
  struct Load {
    std::uint64_t pair = 0;
    double force_n = 0;
  };
  std::vector<Load> loads_;  // sorted by pair
};

// Adds a torque for the next `part_s` to both bodies: at most `limit_nm`, and no more than the torque that stops the
// relative spin or holds `body` on its slope, so that it never reverses a spin. `point_m` and `normal` are those of the
// contact, in world axes.
void resist_rolling(Collider& body, Collider& other, Vec3 point_m, Vec3 normal, double limit_nm, Vec3 gravity_m_s2,
                    double part_s);

}  // namespace ringdown::scene
