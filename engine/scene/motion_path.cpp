#include "engine/scene/motion_path.h"

#include "engine/scene/rotation.h"

#include <algorithm>
#include <cmath>

namespace ringdown::scene {
namespace {

// The shorter way from one rotation to another, as axis times angle in the world.
Vec3 way_between(const Rotation& from, const Rotation& to) {
  Rotation turn = to * inverse(from);
  if (turn.w < 0) turn = Rotation::from_xyzw(-turn.x, -turn.y, -turn.z, -turn.w);
  return to_rotation_vector(normalized(turn));
}

Pose pose_on(const std::vector<Pose>& poses, double every_s, double time_s) {
  const double at = std::clamp(time_s / every_s, 0.0, static_cast<double>(poses.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(at), poses.size() - 1);
  const double part = at - static_cast<double>(k);
  if (part == 0 || k + 1 == poses.size()) return poses[k];
  const Pose &a = poses[k], &b = poses[k + 1];
  return {a.position_m + part * (b.position_m - a.position_m),
          normalized(from_rotation_vector(part * way_between(a.rotation, b.rotation)) * a.rotation)};
}

}  // namespace

Motion motion_on(const MotionPath& path, const Pose& start, Vec3 center_m, double time_s, double part_s) {
  const auto middle = [center_m](const Pose& pose) { return pose.position_m + to_matrix(pose.rotation) * center_m; };
  if (path.poses.empty()) {
    return {middle(start) + time_s * path.velocity_m_s,
            normalized(from_rotation_vector(time_s * path.spin_rad_s) * start.rotation), path.velocity_m_s,
            path.spin_rad_s};
  }
  const double length_s = path.every_s * static_cast<double>(path.poses.size() - 1);
  const double now_s = !(length_s > 0) ? 0 : path.once ? std::min(time_s, length_s) : std::fmod(time_s, length_s);
  const Pose now = pose_on(path.poses, path.every_s, now_s);
  Motion motion{middle(now), now.rotation, {}, {}};
  if (!(length_s > 0) || now_s + part_s > length_s) return motion;
  const Pose next = pose_on(path.poses, path.every_s, now_s + part_s);
  motion.velocity_m_s = (1 / part_s) * (middle(next) - motion.position_m);
  motion.spin_rad_s = (1 / part_s) * way_between(now.rotation, next.rotation);
  return motion;
}

}  // namespace ringdown::scene
