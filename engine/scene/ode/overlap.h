// Moves overlapping bodies apart at the end of a part of a step. This shift gives no velocity, so a body that is moved
// out of another one remains at rest. The potential energy that a body gains is later taken from its kinetic energy
// (Collider::pay_for_lifts); otherwise it would tremble for ever, lifted and falling. Callers must hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

#include <span>

namespace ringdown::scene {

// A contact point at which bodies may have to be moved apart.
struct Overlap {
  Collider *body, *other;
  const ContactPoint* point;  // as found, before the bodies moved
  double max_m;               // maximum distance that the point may be moved apart in this part of the step
};

class Islands;

struct Correction {
  double allowed_m = 0;  // overlap that is left as it is
  double share = 0;      // share of the excess overlap that should be gone after this part
};

// Moves and turns the bodies so that at each point they move apart by the wanted share, the motion of the part
// included. Immovable bodies stay. Islands without such points do not change.
void move_apart(std::span<const Overlap> overlaps, const Correction& correction, const Islands& islands,
                Vec3 gravity_m_s2);

}  // namespace ringdown::scene
