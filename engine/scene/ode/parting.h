// Limits how long meshes that cut through each other are moved apart. If walls cross, no direction leads out: contacts
// disagree, and a body that follows them wanders, or climbs out of a bowl that it should lie in. Such a pair is moved
// for the time that it needs to come out of walls of its thickness; then it is left in place, held there by its
// contacts. Callers must hold OdeLock.
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
    double tried_s = 0;                    // time spent moving the pair apart, less the time without
    double limit_s = 0, deepest_m = 0;     // limit for tried_s; depth of the part's deepest contact
    bool touches = false, differ = false;  // flags for the present part
    Vec3 normal;                           // normal of the part's first contact
  };
  PairMap<Parting> pairs_;
};

}  // namespace ringdown::scene
