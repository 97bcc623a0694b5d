// Who touches whom in one part of a step: groups of bodies, between which nothing passes. What they tell: how large the
// system of equations is that ODE has to solve for each, and whether contacts have made energy. Restitution is asked
// for at each contact point by itself; where a body is struck at several at once, in directions that contradict each
// other, more may come out than went in. Callers hold OdeLock.
//
//   groups.open(items);                        // before the contacts of a part of a step are found
//   groups.unite(body, other, pushed_m_s);     // for each of them, in the order of the touches
//   ... ODE moves the bodies ...
//   if (groups.gain(touches, part_s, gravity, tolerance)) ...   // do it again: some are not elastic now
#pragma once

#include "engine/scene/ode_item.h"
#include "engine/scene/simulation.h"

#include <map>
#include <span>
#include <vector>

namespace ringdown::scene {

class Groups {
 public:
  // Every body that is awake by itself.
  void open(std::map<BodyId, Item>& items);

  // They touch, so that one may gain what the other loses. `pushed_m_s` is how fast they are to be parted for being
  // too deep in each other, which takes energy.
  void unite(Item& body, Item& other, double pushed_m_s);

  // A joint holds them, or one in the air. Its repairs take energy too: their group's is not looked at.
  void join(Item& body, Item* other);

  // Contact points of the group that has most.
  [[nodiscard]] std::size_t most_contacts() const;

  // All that are awake, and what they touch.
  [[nodiscard]] std::span<Item* const> members() const { return members_; }

  // Whether a group of bodies that touch has more energy than before, gravity's work and pushes aside, by more than
  // the share `tolerance`. Its bodies are no longer elastic.
  bool gain(std::span<const Touch> touches, double part_s, Vec3 gravity_m_s2, double tolerance);

 private:
  struct Tie {
    Item* body;
    double pushed_m_s;
  };
  void enter(Item& item);
  void lead(Item& body, Item& other);

  std::vector<Item*> members_;
  std::vector<Tie> ties_;  // of the touch of the same number
};

}  // namespace ringdown::scene
