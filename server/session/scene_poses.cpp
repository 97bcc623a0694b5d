#include "server/session/scene_poses.h"

namespace ringdown::session {

std::uint64_t ScenePoses::send(const scene::World& world, synth::Frame at, Rack& rack) {
  if (!rack.listened()) {
    sent_.clear();  // whoever listens next needs them all
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
  for (const auto& [name, bodies] : objects) {
    const auto [before, is_new] = sent_.try_emplace(name, bodies.pose);
    if (!is_new && before->second == bodies.pose) continue;
    before->second = bodies.pose;
    const auto object = rack.find({.name = name});
    if (!object) continue;
    lost += !rack.push(synth::Producer::scene, {.frame = at,
                                                .object = (*object)->number,
                                                .type = synth::EventType::pose,
                                                .point_m = bodies.pose.position_m,
                                                .rotation = bodies.pose.rotation});
  }
  return lost;
}

}  // namespace ringdown::session
