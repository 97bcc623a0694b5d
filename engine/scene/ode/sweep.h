// When a body that flies and turns first gets into an obstacle, edges and tips included. The answer holds for bodies of
// any shape, but costs more than a ray (ode/flight_probe.h). Callers hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

namespace ringdown::scene {

// A bound on the speed of every point of a body. [m/s]
double point_speed(const Collider& collider, const Motion& motion);

// The time for which `body` may go on as it moves, at most `rest_s`, until it overlaps `obstacle` by half of the
// thinner one's half thickness. If they touch already and come closer, the impact decides how the body goes on, so the
// time is that in which no point of it moves by more than the body's half thickness. [s]
double time_to_meet(Collider& body, Collider& obstacle, double rest_s);

}  // namespace ringdown::scene
