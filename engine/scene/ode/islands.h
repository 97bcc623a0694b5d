// Islands: groups of bodies that touch or are joined, so that impulses can pass within an island but not between two.
// For one part of a step they show how large a system of equations the solver has for each island, and whether contacts
// have created energy. Restitution is applied at every contact point on its own; if a body is struck at several points
// at once, in conflicting directions, the result may have more energy than before. Callers must hold OdeLock.
//
//   islands.open(colliders);                  // before contacts are found
//   islands.unite(body, other, pushed_m_s, bounces);   // for each contact point, in order
//   ... ODE moves the bodies ...
//   if (islands.gained_energy(points, part_s, gravity, tolerance)) ...  // repeat the part: some are less elastic now
#pragma once

#include "engine/scene/ode/collider.h"

#include <span>
#include <vector>

namespace ringdown::scene {

// Returns the body that stands for the island of a body: the body itself if it is in no island.
Collider& island_of(Collider& body);

class Islands {
 public:
  // Makes an island of every body that is awake.
  void open(std::span<Collider* const> colliders);

  // Unites the islands of two bodies that touch. Islands that a driven body touches are exempt from the energy check.
  // `pushed_m_s` is the speed at which the solver would push the two apart because they overlap too far, which adds
  // energy; `bounces` says whether restitution acts.
  void unite(Collider& body, Collider& other, double pushed_m_s, bool bounces);

  // Unites the islands of two bodies that are joined. A null `other` is a joint with the world. Correcting a joint adds
  // energy, so islands with joints are exempt from the energy check.
  void join(Collider& body, Collider* other);

  // Returns the largest number of contact points of any island.
  [[nodiscard]] std::size_t max_contacts() const;

  // Returns true if the body touches only immovable things and has no joints.
  [[nodiscard]] static bool is_alone(const Collider& body) { return !body.island.has_others && !body.island.exempt; }

  // All awake bodies, and those they touch.
  [[nodiscard]] std::span<Collider* const> members() const { return members_; }

  struct Check {
    double tolerance = 0;  // share of its kinetic energy that an island may gain
    bool pushed = false;   // whether the solver has pushed overlapping bodies apart
    bool last = false;     // whether the part can be repeated only once more
  };

  // Returns whether an island that bounces has gained energy, beyond the work of gravity and of pushes. Lowers the
  // elasticity of the bodies of such islands: by the amount that should remove the gain, or to 0 if `last` is set.
  // `points` are those passed to unite(), in that order.
  bool gained_energy(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2, const Check& check);

  // Removes the energy that bouncing islands have gained nevertheless, the work of pushes included, by lowering their
  // velocities.
  void take_gains(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2, double tolerance);

 private:
  struct Link {
    Collider* body;
    double pushed_m_s;
    bool bounces;
  };
  void weigh(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2);
  [[nodiscard]] static bool gains(const IslandState& island, double tolerance);
  void enter(Collider& body);
  void merge(Collider& body, Collider& other);

  std::vector<Collider*> members_;
  std::vector<Link> links_;  // one for each contact point
};

}  // namespace ringdown::scene
