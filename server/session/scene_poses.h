// Sends the poses of a scene's bodies, and of a listener that moves, to the mixer while there is a listener. [scene,
// worker; one at a time]
#pragma once

#include "engine/base/rotation.h"
#include "engine/scene/description.h"
#include "engine/scene/world.h"
#include "server/session/rack.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace ringdown::session {

class ScenePoses {
 public:
  // The time between two poses, unless a step of the world is longer.
  static constexpr double kEvery_s = 0.002;

  // Returns the seconds between two poses of a moving body in a world.
  [[nodiscard]] static double interval_s(const scene::World& world);

  // Forgets the poses that were sent, because another world follows.
  void forget() { *this = {}; }
  // Sends the poses of all objects that have moved since the last call, and that of a listener with a path, for frame
  // `at`, the world's time. If an object
  // begins to move, also sends its pose of one interval before. Sends nothing without a listener. An object that
  // several bodies play is heard from their middle, without rotation. Returns the number of lost events.
  std::uint64_t send(const scene::World& world, const std::optional<scene::ListenerDescription>& listener,
                     synth::Frame at, Rack& rack);

 private:
  struct Sent {
    Pose pose;
    bool moves = false;
  };
  std::map<std::string, Sent> sent_;  // the last pose of each object
  std::optional<Sent> listener_;      // of one that moves
  double next_s_ = 0;
};

}  // namespace ringdown::session
