// Divides what acted on bodies around one frame among the contacts that they had. [any thread]
//
// The unknowns are one impulse for each contact: positive along its normal, and across it at most the friction's share
// of that. They are chosen so that together they explain the pushes of all bodies as well as they can, in the kinetic
// energy of what remains unexplained, by projected Gauss-Seidel steps. So an impulse between two bodies must fit what
// happened to both of them, and what no contact can explain (a hand, a motor, an animator) is left out.
#pragma once

#include "engine/base/rotation.h"
#include "engine/scene/foley/keyed_motion.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::scene {

// A body in the system: first its push, after the solution what of it is unexplained.
struct PushedBody {
  double inverse_mass = 0;
  Matrix3 inverse_inertia{};  // world axes; zero, as the mass: immovable
  Push push;
};

struct PushContact {
  std::size_t first = 0, second = 0;  // indices of bodies
  Vec3 first_arm_m, second_arm_m;     // from the centres of mass, world axes
  Vec3 normal;                        // into the first body
  double friction = 0;
  Vec3 impulse_ns;  // result: received by the first body
};

void solve_pushes(std::span<PushedBody> bodies, std::span<PushContact> contacts);

}  // namespace ringdown::scene
