// Whether a description may be simulated: the ranges of description.h, applied before any physics engine. [any thread]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/description.h"

#include <span>

namespace ringdown::scene {

// Each names the thing and the field: "body 'bell': restitution 3 is outside 0 ... 1".
Result<void> check(const ObjectDescription& object);
Result<void> check(const BodyDescription& body);  // sizes and mass are checked by make_solid (solid.h)
Result<void> check(const StaticDescription& description);
Result<void> check(const EmitterDescription& emitter);

// Its bodies are among `bodies`, two different ones, one of which moves.
Result<void> check(const JointDescription& joint, std::span<const BodyDescription> bodies);

// All of the above, the scene's own numbers, counts, and that names are unique and objects exist.
Result<void> check(const SceneDescription& scene);

}  // namespace ringdown::scene
