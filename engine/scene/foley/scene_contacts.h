// Recovers the contacts of a scene's animated bodies with each other, with fixed bodies and with statics. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/body_store.h"
#include "engine/scene/description.h"
#include "engine/scene/foley/recovery.h"

namespace ringdown::scene {

// The scene must ask for it (SceneDescription::foley). `store` holds its bodies. Bodies that a simulation moves are
// left out: they meet animated ones in the simulation.
Result<Recovery> recover_contacts(const SceneDescription& scene, const BodyStore& store);

}  // namespace ringdown::scene
