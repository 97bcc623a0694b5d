#include "server/session/scene_poses.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::session {

double ScenePoses::interval_s(const scene::World& world) {
  return world.step_s() * std::max(1.0, std::ceil(kEvery_s / world.step_s() - 0.5));
}

std::uint64_t ScenePoses::send(const scene::World& world, synth::Frame at, Rack& rack) {
  if (!rack.listener().on()) {
    sent_.clear();  // the next listener needs all poses
    return 0;
  }
  if (!sent_.empty() && world.time_s() < next_s_) return 0;
  next_s_ = world.time_s() + kEvery_s - 0.5 * world.step_s();
  struct Bodies {
    Pose pose;
    int count = 0;
  };
  std::map<std::string, Bodies> objects;
  for (const scene::BodyState& body : world.bodies()) {
    if (body.object.empty() || body.waiting) continue;
    Bodies& bodies = objects[body.object];
    if (++bodies.count == 1) {
      bodies.pose = {body.position_m, body.rotation};
    } else {
      bodies.pose = {bodies.pose.position_m + (1.0 / bodies.count) * (body.position_m - bodies.pose.position_m), {}};
    }
  }
  std::uint64_t lost = 0;
  const synth::Frame interval = std::llround(interval_s(world) * rack.mixer().sample_rate_hz());
  for (const auto& [name, bodies] : objects) {
    const auto [entry, is_new] = sent_.try_emplace(name, Sent{bodies.pose});
    Sent& before = entry->second;
    const bool moves = before.pose != bodies.pose, begins = moves && !before.moves;
    const Pose stood = std::exchange(before.pose, bodies.pose);
    before.moves = moves;
    if (!is_new && !moves) continue;
    const auto object = rack.find({.name = name});
    if (!object) continue;
    const auto push = [&](synth::Frame frame, const Pose& pose) {
      lost += !rack.push(synth::Producer::scene, {frame, (*object)->number, synth::verb::Pose{pose}});
    };
    if (begins) push(at - interval, stood);
    push(at, bodies.pose);
  }
  return lost;
}

}  // namespace ringdown::session
