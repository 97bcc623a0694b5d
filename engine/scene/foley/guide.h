// Simulates what happened between the frames of an animation, where that leads the bodies to where the frames show
// them, and takes the contacts of the simulation. [one thread at a time]
//
// Frames tell what acted on a body, but several blows of several pairs between two frames only as a sum. A simulation
// that begins an interval with the right poses and velocities tells them apart. The poses are known, and the velocities
// are those with which the simulation of the interval before ended, corrected so that the bodies meet their poses in
// the next frame (shooting.h). If they do not, or only by a large correction, the animation follows other laws than the
// simulation. The velocities of such bodies are guessed again in the next interval, and count once two intervals agree
// on them.
#pragma once

#include "engine/scene/description.h"
#include "engine/scene/foley/recovery.h"
#include "engine/scene/solid.h"

#include <cstddef>
#include <span>
#include <vector>

namespace ringdown::scene {

// A body of Recovery::bodies as the simulation needs it; the solid of a static is empty.
struct GuidedBody {
  Solid solid;
  CollisionFilter filter;
  double gravity_factor = 1;
};

// Replaces contacts of `recovery` by those of the simulation, in the intervals and for the bodies where it is right.
// `bodies` are those of the recovery, in its order. Simulates until some seconds of work are done, less what the
// recovery had to do, and leaves the rest as it is; so are scenes with joints, and those in which only balls move
// and none strikes another, whose contacts the frames tell.
void guide(const SceneDescription& scene, std::span<const GuidedBody> bodies, std::size_t frames, Recovery& recovery);

}  // namespace ringdown::scene
