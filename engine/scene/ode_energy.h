// Sees to it that contacts make no energy. Restitution is asked for at each contact point by itself; where a body is
// struck at several at once, in directions that contradict each other, more may come out than went in. Callers hold
// OdeLock.
//
//   ledger.open(items);                        // before the contacts of a part of a step are found
//   ledger.unite(body, other, pushed_m_s);     // for each of them, in the order of the touches
//   ... ODE moves the bodies ...
//   if (ledger.close(touches, part_s, gravity, tolerance)) ...   // do it again: elastic() now says no for some
#pragma once

#include "engine/scene/ode_item.h"
#include "engine/scene/simulation.h"

#include <map>
#include <span>
#include <vector>

namespace ringdown::scene {

class EnergyLedger {
 public:
  // Every body by itself; all are elastic.
  void open(std::map<BodyId, Item>& items);

  // They touch, so that one may gain what the other loses. `pushed_m_s` is how fast they are to be parted for being
  // too deep in each other, which takes energy.
  void unite(Item& body, Item& other, double pushed_m_s);

  // A joint's repairs take energy too: the group of what it holds is not looked at.
  void exempt(Item& body);

  // Whether a group of bodies that touch has more energy than before, gravity's work and pushes aside, by more than
  // the share `tolerance`. Its bodies are no longer elastic.
  bool close(std::map<BodyId, Item>& items, std::span<const Touch> touches, double part_s, Vec3 gravity_m_s2,
             double tolerance);

 private:
  std::vector<double> pushed_m_s_;
};

}  // namespace ringdown::scene
