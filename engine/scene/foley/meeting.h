// Finds where two bodies touch between two frames of an animation. [one thread at a time]
#pragma once

#include "engine/scene/foley/keyed_motion.h"
#include "engine/scene/foley/limits.h"
#include "engine/scene/ode/posed_colliders.h"

#include <cstddef>
#include <vector>

namespace ringdown::scene {

// One of the two bodies.
struct Meeter {
  BodyId id = 0;
  const KeyedMotion* motion = nullptr;
};

// The contact points of a pair in one interval. No points: the two do not touch.
struct Meeting {
  std::vector<PosedContact> points;       // normals into the first body
  Motion first, second;                   // as the two come to each other
  double share = 0;                       // of the interval, where the points were found
  bool onward = false, backward = false;  // on which of both ways the two were found to touch
};

// Looks where two bodies touch in interval `k`. `pushed` tells which way the contact must have pushed the first body
// away from the second, as a change of its relative velocity around the frames before and after the interval.
//
// Frames lie up to an interval away from a blow, so that in no frame the bodies need to touch. The blow's share of the
// interval follows from `pushed`. The bodies go on to there from the frames before, and back to there from the frames
// after. Where they overlap, the search goes back to where they begin to. If they touch nowhere, one is moved against
// the push by up to the gap that the limits allow, because solvers keep margins and animators are not exact.
Meeting find_meeting(PosedColliders& colliders, const Meeter& first, const Meeter& second, std::size_t k,
                     Vec3 pushed_before, Vec3 pushed_after, double gap_m);

}  // namespace ringdown::scene
