#include "server/session/scene_poses.h"

#include "engine/scene/motion_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ringdown::session {

double ScenePoses::interval_s(const scene::World& world) {
  return world.step_s() * std::max(1.0, std::ceil(kEvery_s / world.step_s() - 0.5));
}

std::uint64_t ScenePoses::send(const scene::World& world, const std::optional<scene::ListenerDescription>& listener,
                               synth::Frame at, Rack& rack) {
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
  // Tells whether a pose must be sent; if the object begins to move, `stood` is its pose of one interval before.
  struct News {
    bool any = false;
    std::optional<Pose> stood;
  };
  const auto take = [](Sent& before, const Pose& pose) {
    const bool moves = before.pose != pose;
    const News news{moves, moves && !before.moves ? std::optional(before.pose) : std::nullopt};
    before = {pose, moves};
    return news;
  };
  const auto push = [&](synth::Frame frame, synth::ObjectNumber object, const auto& verb) {
    lost += !rack.push(synth::Producer::scene, {frame, object, verb});
  };
  for (const auto& [name, bodies] : objects) {
    const auto [entry, is_new] = sent_.try_emplace(name, Sent{bodies.pose});
    const News news = take(entry->second, bodies.pose);
    if (!is_new && !news.any) continue;
    const auto object = rack.find({.name = name});
    if (!object) continue;
    if (news.stood) push(at - interval, (*object)->number, synth::verb::Pose{*news.stood});
    push(at, (*object)->number, synth::verb::Pose{bodies.pose});
  }
  if (listener && listener->path) {
    const auto& path = *listener->path;
    const scene::Motion motion = scene::motion_on(path, path.poses.front(), {}, world.time_s(), kEvery_s);
    const Pose pose{motion.position_m, motion.rotation};
    if (!listener_) listener_ = Sent{pose};
    const News news = take(*listener_, pose);
    if (news.stood) push(at - interval, 0, synth::verb::Listener{*news.stood});
    if (news.any) push(at, 0, synth::verb::Listener{pose});
  }
  return lost;
}

}  // namespace ringdown::session
