// Moves overlapping bodies apart at the end of a part of a step. The way out of an overlap is no motion: it gives no
// velocity, so that a body that is moved out of another rests meanwhile. What a body gains in height it owes
// in kinetic energy (Collider::pay_for_lifts), or it would tremble for ever, lifted and falling. Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

#include <span>

namespace ringdown::scene {

// A contact point, as far as its bodies have to be moved.
struct Overlap {
  Collider *body, *other;
  const ContactPoint* point;  // as found, before the bodies moved
  double max_m;               // the farthest that the point may be moved apart in this part of the step
};

struct Correction {
  double allowed_m = 0;  // overlap at which two bodies may stay
  double share = 0;      // of the overlap beyond what is allowed that should be gone after this part
};

// Moves and turns the bodies so that they move apart at each point by its share, the motion of the part included.
// Bodies that cannot move stay. Of an island in which no point needs it, nothing changes.
void move_apart(std::span<const Overlap> overlaps, const Correction& correction, Vec3 gravity_m_s2);

}  // namespace ringdown::scene
