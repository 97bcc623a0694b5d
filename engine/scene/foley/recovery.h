// Recovers the contacts of animated bodies from their motion: the impulses that change their velocities, at the moments
// between the frames where they must have acted, and the forces of contacts that last. [worker]
//
// 1. keyed_motion.h tells what acted on every body around every frame.
// 2. meeting.h finds where a body that something acts on touches another one, in every interval between two frames.
// 3. touches.h finds out which of these touches are blows.
// 4. push_solver.h divides what acted on the bodies among blows and lasting contacts.
// 5. For every pair of bodies, series.h takes the blows out of what the frames tell; the rest is a contact that lasts.
//
// guide.h replaces the contacts of a recovery by those of a simulation, as far as that meets the frames.
#pragma once

#include "engine/scene/foley/keyed_motion.h"
#include "engine/scene/foley/limits.h"
#include "engine/scene/foley/meeting.h"
#include "engine/scene/ode/posed_colliders.h"
#include "engine/scene/pair_filter.h"

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace ringdown::scene {

// A body whose contacts are recovered, or that others touch.
struct FoleyBody {
  BodyId id = 0;
  std::string name;
  KeyedMotion motion{Motion{}};
  FrictionSurface surface;
  double radius_m = 0;  // about the centre of mass; of bodies that move
};

// A blow between two bodies: points with normals into the first body, and the impulses that it received there.
struct RecoveredBlow {
  double time_s = 0;
  BodyId first = 0, second = 0;
  MotionPair motions;
  std::vector<PosedContact> points;
  std::vector<Vec3> impulses_ns;
  double approach_m_s = 0;
};

// A contact that lasts from one frame to the next. Its force on the first body goes from one value to the other, and
// its points move with the mean of the points.
struct RecoveredTouch {
  std::size_t interval = 0;
  std::size_t first = 0, second = 0;  // indices of bodies
  std::vector<PosedContact> points;
  std::vector<double> shares;  // of the force that each point carries
  Vec3 start_force_n, end_force_n;
  Vec3 start_shift_m, end_shift_m;  // of the points, at both frames
};

// The contact points of one step of a simulation (guide.h).
struct GuidedStep {
  double time_s = 0;
  std::vector<ContactPoint> points;
  std::shared_ptr<std::deque<MotionPair>> motions;  // of the points, which refer to them
};

struct Recovery {
  double every_s = 0;
  std::vector<FoleyBody> bodies;
  std::vector<RecoveredBlow> blows;     // by time
  std::vector<RecoveredTouch> touches;  // by interval
  std::vector<GuidedStep> steps;        // by time
  std::vector<std::string> notes;       // sentences: bodies that jump, motion that no contact explains
};

// `bodies` and `colliders` hold the bodies and the statics of the scene, those that move first; all motions have frames
// at the same intervals, `frames` at most.
Recovery recover(std::vector<FoleyBody> bodies, PosedColliders& colliders, const PairFilter& filter,
                 const FoleyLimits& limits, double gravity_m_s2, double every_s, std::size_t frames);

}  // namespace ringdown::scene
