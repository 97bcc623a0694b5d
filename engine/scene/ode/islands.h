// Islands: groups of bodies that touch or are joined, so that impulses can pass within an island but not between two.
// For one part of a step they show how large a system of equations the solver has for each island, and whether contacts
// have created energy. Restitution is applied at every contact point on its own; if a body is struck at several points
// at once, in conflicting directions, the result may have more energy than before. Callers must hold OdeLock.
//
//   islands.open(colliders);                  // before contacts are found
//   islands.unite(body, other);               // for each contact point, in order
//   islands.set_speeds(contact, pushed_m_s, bounces);
//   ... ODE moves the bodies ...
//   islands.settle_all();
//   if (islands.gained_energy(points, part_s, gravity, exact, last)) ...  // solve some again with other speeds
//   islands.end_part(points, part_s, gravity);
#pragma once

#include "engine/scene/ode/collider.h"

#include <span>
#include <vector>

namespace ringdown::scene {

class Islands {
 public:
  // Makes an island of every body that is awake.
  void open(std::span<Collider* const> colliders);

  // Unites the islands of two bodies that touch. Islands that a driven body touches are exempt from the energy check.
  void unite(Collider& body, Collider& other);

  // Describes the contact point of one call of unite(), by its number. `pushed_m_s` is the speed at which the solver
  // would push the two bodies apart because they overlap too far, which adds energy; `bounces` says whether restitution
  // acts.
  void set_speeds(std::size_t contact, double pushed_m_s, bool bounces);

  // Unites the islands of two bodies that are joined. A null `other` is a joint with the world. Correcting a joint adds
  // energy, so islands with joints are exempt from the energy check.
  void join(Collider& body, Collider* other);

  // Returns the largest number of contact points of any island.
  [[nodiscard]] std::size_t max_contacts() const;

  // All awake bodies, and the movable ones that they touch.
  [[nodiscard]] std::span<Collider* const> members() const { return members_; }

  // Returns the body that stands for the island of a body: the body itself if it is in no island.
  [[nodiscard]] const Collider* island_of(const Collider& body) const {
    return body.island.number_ ? members_[root_of(*body.island.number_)] : &body;
  }
  // Returns the number of contact points of the body's island.
  [[nodiscard]] std::size_t contacts_of(const Collider& body) const {
    return body.island.number_ ? nodes_[root_of(*body.island.number_)].contacts : 0;
  }
  // Returns a number below members().size() that is the same for all members of an island.
  [[nodiscard]] std::size_t number_of(const Collider& member) const { return root_of(*member.island.number_); }

  // An island is settled while it keeps the motion that the solver has found, and others are solved again.
  [[nodiscard]] bool is_settled(const Collider& member) const { return nodes_[number_of(member)].settled; }
  void settle(const Collider& member) { nodes_[number_of(member)].settled = true; }
  void settle_all();
  void unsettle_all();

  // Returns true if a member touches only immovable things and has no joints.
  [[nodiscard]] bool is_alone(const Collider& member) const;
  // Returns the share of its contacts' restitution that acts on any body in this part of the step.
  [[nodiscard]] static double elasticity(const Collider& body) { return body.island.elasticity_; }

  // Returns whether an island that bounces has gained energy, beyond the work of gravity and of the pushes of a solver
  // that is not exact. Lowers the elasticity of the bodies of such islands: by the amount that should remove the gain,
  // or to 0 if `last` is set. Such islands are no longer settled. `points` are those passed to unite(), in that order.
  bool gained_energy(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2, bool exact, bool last);

  // Removes the energy that bouncing islands have gained nevertheless, the work of pushes included, by lowering their
  // velocities. All bodies become fully elastic again.
  void end_part(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2);

 private:
  struct Node {
    std::size_t parent;       // number of a member of the island; the node's own number: it is the island's root
    double before_j = 0;      // kinetic energy before the part of the step
    Vec3 velocity_m_s;        // velocity before the part of the step
    bool exempt = false;      // whether the body is exempt from the energy check
    bool has_others = false;  // whether the body touches a movable body
    bool held = false;        // whether the body touches something immovable
    std::size_t size = 1, contacts = 0;  // of a root: numbers of bodies and of contact points of its island
    bool settled = false;                // of a root
  };
  struct Link {
    std::size_t body;
    double pushed_m_s = 0;
    bool bounces = false;
  };
  struct Sum;  // of an island's members
  [[nodiscard]] std::vector<Sum> weigh(std::span<const ContactPoint> points, double part_s, Vec3 gravity_m_s2) const;
  [[nodiscard]] std::size_t root_of(std::size_t number) const;
  std::size_t enter(Collider& body);
  void merge(std::size_t body, std::size_t other);

  std::vector<Collider*> members_;
  std::vector<Node> nodes_;  // one for each member
  std::vector<Link> links_;  // one for each contact point
};

}  // namespace ringdown::scene
