#include "clients/viewer/render/gizmo.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr float kAxisBegin = 0.3F, kAxisEnd = 1.3F;  // of an axis, in radii of the rings
constexpr float kSquareAt = 1.3F, kSquare = 0.08F;   // place and half edge of the square, in radii
constexpr int kParts = 32;                           // of a ring's line
constexpr float kEdgeOn = 0.15F;  // a ring is seen from its edge if the sine of the angle between is below this

bool turns(Handle handle) { return handle >= Handle::turn_x && handle <= Handle::turn_z; }

glm::vec3 axis_of(Handle handle) {
  const int axis = static_cast<int>(handle) % 3;
  return {axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0};
}

float distance_to_segment(glm::vec2 at, glm::vec2 a, glm::vec2 b) {
  const glm::vec2 way = b - a;
  const float squared = glm::dot(way, way);
  const float share = squared > 0 ? std::clamp(glm::dot(at - a, way) / squared, 0.0F, 1.0F) : 0.0F;
  return glm::distance(at, a + share * way);
}

}  // namespace

Gizmo::Gizmo(glm::vec3 centre_m, const Camera& camera, int width, int height)
    : centre_m_(centre_m), camera_(camera), width_(width), height_(height) {
  const float depth_m = std::max(glm::dot(centre_m - camera.position_m, camera.forward()), Camera::kMinZoom);
  radius_m_ = 2 * kRadius * depth_m * std::tan(camera.field_of_view / 2);
}

std::vector<glm::vec3> Gizmo::points_of(Handle handle) const {
  const auto at = [this](glm::vec3 direction) { return centre_m_ + radius_m_ * direction; };
  if (handle == Handle::size) {
    const glm::vec3 right = camera_.right(), up = camera_.up(), middle = kSquareAt * glm::normalize(right - up);
    std::vector<glm::vec3> corners;
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}, {-1, -1}}) {
      corners.push_back(at(middle + kSquare * (static_cast<float>(x) * right + static_cast<float>(y) * up)));
    }
    return corners;
  }
  const glm::vec3 axis = axis_of(handle);
  if (!turns(handle)) return {at(kAxisBegin * axis), at(kAxisEnd * axis)};
  const glm::vec3 towards = glm::normalize(camera_.position_m - centre_m_);
  const glm::vec3 level = towards - glm::dot(towards, axis) * axis;  // of the ring's plane
  const bool is_round = glm::length(level) < kEdgeOn;                // the whole ring faces the camera
  const glm::vec3 first = is_round ? glm::vec3(axis.y, axis.z, axis.x) : glm::normalize(level);
  const glm::vec3 second = glm::cross(axis, first);
  const float half = (is_round ? 1.0F : 0.5F) * std::numbers::pi_v<float>;
  std::vector<glm::vec3> arc;
  for (int i = 0; i <= kParts; ++i) {
    const float angle = half * (2 * static_cast<float>(i) / kParts - 1);
    arc.push_back(at(std::cos(angle) * first + std::sin(angle) * second));
  }
  return arc;
}

std::vector<glm::vec2> Gizmo::line_of(Handle handle) const {
  std::vector<glm::vec2> line;
  for (const glm::vec3& point : points_of(handle)) {
    const auto at = place_of(point);
    if (!at) return {};
    line.push_back(*at);
  }
  return line;
}

std::optional<Handle> Gizmo::handle_at(glm::vec2 at) const {
  std::optional<Handle> found;
  float nearest = kGrip_px;
  for (const Handle handle : kHandles) {
    const std::vector<glm::vec2> line = line_of(handle);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const float away = distance_to_segment(at, line[i - 1], line[i]);
      if (away > nearest) continue;
      nearest = away;
      found = handle;
    }
  }
  return found;
}

// The place on the axis that is nearest to the ray through a point of the picture, from the centre. An axis that points
// at the camera has none: 0.
float Gizmo::way_along(glm::vec3 axis, glm::vec2 at) const {
  const auto [origin, direction] = ray(at);
  const glm::vec3 from_origin = centre_m_ - origin;
  const float slope = glm::dot(axis, direction), spread = 1 - slope * slope;
  if (spread < kEdgeOn * kEdgeOn / 4) return 0;
  return (slope * glm::dot(direction, from_origin) - glm::dot(axis, from_origin)) / spread;
}

// The angle between the places where two rays meet the ring's plane. Where the ring is seen from its edge, rays meet
// the plane far away or not at all; the mouse then pulls the near side of the ring along.
float Gizmo::angle_about(glm::vec3 axis, glm::vec2 from, glm::vec2 to) const {
  const glm::vec3 towards = glm::normalize(camera_.position_m - centre_m_);
  if (std::abs(glm::dot(towards, axis)) < kEdgeOn) {
    const glm::vec3 along = glm::normalize(glm::cross(axis, towards));
    return (way_along(along, to) - way_along(along, from)) / radius_m_;
  }
  const auto meet = [&](glm::vec2 at) {
    const auto [origin, direction] = ray(at);
    return origin + glm::dot(centre_m_ - origin, axis) / glm::dot(direction, axis) * direction - centre_m_;
  };
  const glm::vec3 a = meet(from), b = meet(to);
  return std::atan2(glm::dot(axis, glm::cross(a, b)), glm::dot(a, b));
}

Gizmo::Change Gizmo::change_by(Handle handle, glm::vec2 from, glm::vec2 to) const {
  const glm::vec3 axis = axis_of(handle);
  if (turns(handle)) return {.turn = glm::angleAxis(angle_about(axis, from, to), axis)};
  if (handle != Handle::size) return {.move_m = (way_along(axis, to) - way_along(axis, from)) * axis};
  const auto middle = place_of(centre_m_);
  if (!middle) return {};
  const float factor = glm::distance(to, *middle) / std::max(glm::distance(from, *middle), 1.0F);
  return {.size = std::clamp(factor, 1 / kMaxFactor, kMaxFactor)};
}

}  // namespace ringdown::viewer
