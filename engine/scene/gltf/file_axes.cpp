#include "engine/scene/gltf/file_axes.h"

#include "engine/scene/fixed_contacts.h"
#include "engine/scene/rotation.h"

#include <cmath>
#include <numbers>

namespace ringdown::scene {

using modal::Json;

Vec3 to_file(Vec3 v) { return {v.x, v.z, -v.y}; }

Rotation to_file(const Rotation& q) {
  const double h = std::sqrt(0.5);
  return normalized(Rotation::from_xyzw(-h, 0, 0, h) * q);
}

Json json_of(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const Rotation& q) { return Json::array({q.x, q.y, q.z, q.w}); }

Rotation turn_between(Vec3 from, Vec3 to) {
  const Vec3 axis = cross(from, to);
  if (length(axis) < 1e-12) return dot(from, to) > 0 ? Rotation{} : about(any_across(from), std::numbers::pi);
  return about(axis, std::atan2(length(axis), dot(from, to)));
}

Json camera_of(const CameraDescription& camera) {
  return {{"type", "perspective"},
          {"perspective", {{"yfov", camera.field_of_view_degrees * std::numbers::pi / 180}, {"znear", 0.01}}}};
}

Json camera_node_of(const CameraDescription& camera) {
  const Vec3 way = to_file(camera.target_m - camera.position_m);
  const double yaw = std::atan2(-way.x, -way.z), pitch = std::atan2(way.y, std::hypot(way.x, way.z));
  return {{"name", "camera"},
          {"camera", 0},
          {"translation", json_of(to_file(camera.position_m))},
          {"rotation", json_of(normalized(about({0, 1, 0}, yaw) * about({1, 0, 0}, pitch)))}};
}

}  // namespace ringdown::scene
