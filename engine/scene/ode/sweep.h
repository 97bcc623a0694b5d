// Finds when a body that flies and turns first enters an obstacle, edges and tips included. The answer holds for bodies
// of any shape, but costs more than a ray (ode/flight_probe.h). Callers must hold OdeLock.
#pragma once

#include "engine/scene/ode/collider.h"

namespace ringdown::scene {

// Returns a bound on the speed of every point of a body. [m/s]
double point_speed(const Collider& collider, const Motion& motion);

// Returns the time, at most `rest_s`, for which `body` may continue its motion until it overlaps `obstacle` by half of
// the smaller half thickness of the two. If they already touch and approach, the impact decides the further motion, so
// the result is the time in which no point of the body moves by more than its half thickness. [s]
double time_to_meet(Collider& body, Collider& obstacle, double rest_s);

}  // namespace ringdown::scene
