#include "clients/viewer/render/camera.h"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {

Camera Camera::from(glm::vec3 position_m, glm::vec3 target_m, float field_of_view) {
  Camera camera;
  camera.position_m = position_m;
  if (field_of_view > 0) camera.field_of_view = field_of_view;
  const glm::vec3 way = target_m - position_m;
  const float level = std::hypot(way.x, way.y);
  if (level > 0) camera.yaw = std::atan2(way.y, way.x);
  if (level > 0 || way.z != 0) camera.pitch = std::clamp(std::atan2(way.z, level), -kSteepest, kSteepest);
  return camera;
}

float Camera::fitted_field_of_view(float field_of_view, float aspect) {
  if (aspect >= kComposedAspect) return field_of_view;
  return 2 * std::atan(std::tan(field_of_view / 2) * kComposedAspect / std::max(aspect, 0.1F));
}

Camera Camera::showing(Sphere scene, float aspect) {
  const float half_up = kDefaultFieldOfView / 2, half_across = std::atan(std::tan(half_up) * aspect);
  const float distance = 1.05F * scene.radius_m / std::sin(std::min(half_up, half_across));
  return from(scene.centre + distance * glm::normalize(glm::vec3(0.25F, -1, 0.45F)), scene.centre);
}

void Camera::look(float dx, float dy, int height) {
  const float per_pixel = 2 * std::tan(field_of_view / 2) / static_cast<float>(std::max(height, 1));
  yaw = std::remainder(yaw - dx * per_pixel, 2 * glm::pi<float>());
  pitch = std::clamp(pitch - dy * per_pixel, -kSteepest, kSteepest);
}

void Camera::zoom(float steps, float distance_m) {
  const float left = std::clamp(distance_m * std::pow(kZoomStep, steps), std::min(kMinZoom, distance_m),
                                std::max(kMaxZoom, distance_m));
  position_m += (distance_m - left) * forward();
}

void Camera::move(float forward_m, float right_m, float up_m) {
  position_m += forward_m * forward() + right_m * right() + glm::vec3(0, 0, up_m);
}

glm::vec3 Camera::forward() const {
  return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

glm::vec3 Camera::right() const { return {std::sin(yaw), -std::cos(yaw), 0}; }

glm::vec3 Camera::up() const { return glm::cross(right(), forward()); }

glm::mat4 Camera::view() const { return glm::lookAt(position_m, position_m + forward(), up()); }

glm::mat4 Camera::projection(float aspect, Sphere scene) const {
  const float far = glm::distance(position_m, scene.centre) + kGround * scene.radius_m;
  return glm::perspective(field_of_view, aspect, far / 5000, far);
}

Ray Camera::ray_through(float x, float y, int width, int height) const {
  const float half = std::tan(field_of_view / 2), w = static_cast<float>(width), h = static_cast<float>(height);
  const float across = (2 * x - w) / h * half, upward = (1 - 2 * y / h) * half;
  return {position_m, glm::normalize(forward() + across * right() + upward * up())};
}

std::optional<glm::vec2> Camera::project(glm::vec3 point_m, int width, int height) const {
  const glm::vec3 way = point_m - position_m;
  const float depth = glm::dot(way, forward());
  if (!(depth > 0)) return std::nullopt;
  const float pixels = static_cast<float>(height) / (2 * std::tan(field_of_view / 2) * depth);
  return glm::vec2(static_cast<float>(width) / 2 + glm::dot(way, right()) * pixels,
                   static_cast<float>(height) / 2 - glm::dot(way, up()) * pixels);
}

}  // namespace ringdown::viewer
