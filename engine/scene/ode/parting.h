// How long meshes that cut through each other are moved apart. Where walls cross, no direction is the way out: contacts
// disagree, and a body that follows them wanders, or climbs out of a bowl that it should lie in. Such a pair is moved
// until it could have come out of walls of its thickness; then it is left as it is, and held there by its contacts.
// Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/overlap.h"
#include "engine/scene/pair_map.h"

#include <span>

namespace ringdown::scene {

class Partings {
 public:
  // Sets `max_m` to 0 in those overlaps of a part of a step whose bodies have been moved apart for long enough.
  void limit(std::span<Overlap> overlaps, double part_s);

 private:
  struct Parting {
    double tried_s = 0;                    // how long the pair has been moved apart, less the time that it was not
    double limit_s = 0, deepest_m = 0;     // of the part's contacts
    bool touches = false, differ = false;  // in the part
    Vec3 normal;                           // of the part's first contact
  };
  PairMap<Parting> pairs_;
};

}  // namespace ringdown::scene
