// Checks whether a description can be simulated: the ranges of description.h, before any physics engine. [any thread]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <span>

namespace ringdown::scene {

// An error names the thing and the field: "body 'bell': restitution 3 is outside 0 ... 1".
Result<void> check(const ObjectDescription& object);
Result<void> check(const BodyDescription& body);  // sizes and mass are checked by make_solid (solid.h)
Result<void> check(const StaticDescription& description);
Result<void> check(const EmitterDescription& emitter);

// Also checks that the joint's two bodies are among `bodies`, that they differ, and that at least one can move.
Result<void> check(const JointDescription& joint, std::span<const BodyDescription> bodies);

// Checks every part of a scene, its own numbers and counts, that names are unique and that objects exist.
Result<void> check(const SceneDescription& scene);

}  // namespace ringdown::scene
