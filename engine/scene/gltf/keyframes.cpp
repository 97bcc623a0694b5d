#include "engine/scene/gltf/keyframes.h"

#include "engine/scene/gltf/file_axes.h"
#include "engine/scene/rotation.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace ringdown::scene {

using modal::Json;

void KeyframeWriter::add(std::size_t node, const MotionPath& path, double start_s) {
  std::vector<float> places, turns;
  Rotation last;
  for (const Pose& pose : path.poses) {
    const Vec3 place = to_file(pose.position_m);
    Rotation turn = to_file(normalized(pose.rotation));
    // Neighbours of opposite sign are the same rotation, but not every program takes the shorter way between them.
    if (turn.x * last.x + turn.y * last.y + turn.z * last.z + turn.w * last.w < 0)
      turn = Rotation::from_xyzw(-turn.x, -turn.y, -turn.z, -turn.w);
    last = turn;
    for (const double x : {place.x, place.y, place.z}) places.push_back(static_cast<float>(x));
    for (const double x : {turn.x, turn.y, turn.z, turn.w}) turns.push_back(static_cast<float>(x));
  }
  const std::size_t times = times_of(path);
  add_channel(node, "translation", times, writer_.add_floats(places, 3), "LINEAR");
  add_channel(node, "rotation", times, writer_.add_floats(turns, 4), "LINEAR");
  if (!(start_s > 0) || path.poses.size() < 2) return;
  // A body that starts after the end appears in the last frame, so that the animation does not become longer.
  const double end_s = path.every_s * static_cast<double>(path.poses.size() - 1);
  const std::vector<float> moments{0, static_cast<float>(std::min(start_s, end_s))}, scales{0, 0, 0, 1, 1, 1};
  add_channel(node, "scale", writer_.add_floats(moments, 1, modal::GlbWriter::Use::times),
              writer_.add_floats(scales, 3), "STEP");
}

Json KeyframeWriter::finished() const {
  if (channels_.empty()) return Json::array();
  return Json::array({{{"name", "simulation"}, {"channels", channels_}, {"samplers", samplers_}}});
}

void KeyframeWriter::add_channel(std::size_t node, const char* target, std::size_t times, std::size_t values,
                                 const char* way) {
  channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", target}}}});
  samplers_.push_back({{"input", times}, {"output", values}, {"interpolation", way}});
}

std::size_t KeyframeWriter::times_of(const MotionPath& path) {
  const auto [found, is_new] = times_.try_emplace({path.every_s, path.poses.size()});
  if (!is_new) return found->second;
  std::vector<float> times;
  for (std::size_t k = 0; k < path.poses.size(); ++k)
    times.push_back(static_cast<float>(static_cast<double>(k) * path.every_s));
  found->second = writer_.add_floats(times, 1, modal::GlbWriter::Use::times);
  return found->second;
}

}  // namespace ringdown::scene
