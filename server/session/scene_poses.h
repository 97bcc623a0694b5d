// Tells the mixer where the bodies of a scene are, while somebody listens. [scene, worker; one at a time]
#pragma once

#include "engine/base/rotation.h"
#include "engine/scene/world.h"
#include "server/session/rack.h"

#include <cstdint>
#include <map>
#include <string>

namespace ringdown::session {

class ScenePoses {
 public:
  // Poses come once in so many seconds, or with every step of the world if that is longer.
  static constexpr double kEvery_s = 0.002;

  // Seconds between two poses of what moves in a world.
  [[nodiscard]] static double interval_s(const scene::World& world);

  // Forgets what was sent: another world follows.
  void forget() { *this = {}; }
  // Sends the poses of what has moved since the last call, for frame `at`, which is the world's time, and where it has
  // stood an interval before when it begins to move. Nothing without a listener. An object that several bodies play is
  // heard from the middle of them, not turned. Returns how many events were lost.
  std::uint64_t send(const scene::World& world, synth::Frame at, Rack& rack);

 private:
  struct Sent {
    Pose pose;
    bool moves = false;
  };
  std::map<std::string, Sent> sent_;  // of each object
  double next_s_ = 0;
};

}  // namespace ringdown::session
