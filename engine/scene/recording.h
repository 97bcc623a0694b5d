// Simulates a scene offline and records its bodies as keyframes, as an animator's program would have them. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/scene/body_store.h"
#include "engine/scene/contact/heard_contact.h"
#include "engine/scene/description.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace ringdown::scene {

struct Recording {
  // The scene with all bodies of its emitters among the others, in the order of their numbers. Every body that moved is
  // fixed and follows a path (motion_path.h) with a pose in each frame; before its start_s it stands at its start, and
  // after it has left the scene it stays at its last pose. There are no joints, no scatter, and bodies do not break.
  SceneDescription scene;
  std::vector<HeardContact> contacts;  // of the simulation
  std::vector<std::string> notices;    // sentences of the simulation: a body was reset, removed, ...
};

// Records the first `duration_s` of a scene, with `frames_per_s` poses in each second. Between two steps of the scene,
// centres of mass go straight and bodies turn steadily. `go_on` is called once a frame with the share that is done; if
// it returns false, the recording fails as cancelled. Fails as World::create() does, and if one path would have more
// than kMaxPathPoses poses.
Result<Recording> record(const SceneDescription& scene, std::span<const SoundingObject> objects, double frames_per_s,
                         const std::function<bool(double done)>& go_on = {});

}  // namespace ringdown::scene
