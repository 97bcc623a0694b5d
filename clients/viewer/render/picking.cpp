#include "clients/viewer/render/picking.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// The point at which a ray hits a shape, in the frame of the shape. If it misses, the distance is kFar.
struct Meeting {
  float distance = kFar;
  glm::vec3 normal{0};
};

// The part of a ray inside a box.
struct Span {
  float enter = -kFar, leave = kFar;
  int axis = 0;        // normal axis of the face through which the ray enters
  int leave_axis = 0;  // normal axis of the face through which it leaves
  [[nodiscard]] bool ahead() const { return enter <= leave && leave >= 0; }
};

Span inside_box(const Ray& ray, glm::vec3 low, glm::vec3 high) {
  Span span;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) {
      if (ray.origin[axis] < low[axis] || ray.origin[axis] > high[axis]) return {kFar, -kFar};
      continue;
    }
    float near = (low[axis] - ray.origin[axis]) / ray.direction[axis];
    float far = (high[axis] - ray.origin[axis]) / ray.direction[axis];
    if (near > far) std::swap(near, far);
    if (near > span.enter) {
      span.enter = near;
      span.axis = axis;
    }
    if (far < span.leave) {
      span.leave = far;
      span.leave_axis = axis;
    }
  }
  return span;
}

Meeting meet(const Ray& ray, const BoxShape& box) {
  const Span span = inside_box(ray, -box.size_m / 2.0F, box.size_m / 2.0F);
  if (!span.ahead()) return {};
  Meeting meeting;
  meeting.distance = span.enter >= 0 ? span.enter : span.leave;
  meeting.normal[span.enter >= 0 ? span.axis : span.leave_axis] = 1;
  return meeting;
}

Meeting meet(const Ray& ray, const SphereShape& sphere) {
  const float along = glm::dot(ray.origin, ray.direction);
  const glm::vec3 nearest = ray.origin - along * ray.direction;
  const float rest = sphere.radius_m * sphere.radius_m - glm::dot(nearest, nearest);
  if (rest < 0) return {};
  const float half = std::sqrt(rest);
  const float distance = -along - half >= 0 ? -along - half : -along + half;
  if (distance < 0) return {};
  return {distance, (ray.origin + distance * ray.direction) / sphere.radius_m};
}

// The distance along the ray to a triangle, hit from either side (Moeller and Trumbore, 1997).
float meet_triangle(const Ray& ray, glm::vec3 a, glm::vec3 ab, glm::vec3 ac) {
  const glm::vec3 p = glm::cross(ray.direction, ac);
  const float volume = glm::dot(ab, p);
  if (volume == 0) return kFar;
  const glm::vec3 from_a = ray.origin - a, q = glm::cross(from_a, ab);
  const float u = glm::dot(from_a, p) / volume, v = glm::dot(ray.direction, q) / volume;
  const float distance = glm::dot(ac, q) / volume;
  return u >= 0 && v >= 0 && u + v <= 1 && distance >= 0 ? distance : kFar;
}

Meeting meet(const Ray& ray, const DrawnMesh* mesh) {
  if (!inside_box(ray, mesh->low_m, mesh->high_m).ahead()) return {};
  Meeting nearest;
  for (const auto& [i, j, k] : mesh->triangles) {
    const glm::vec3 a = mesh->positions[i], ab = mesh->positions[j] - a, ac = mesh->positions[k] - a;
    const float distance = meet_triangle(ray, a, ab, ac);
    if (distance < nearest.distance) nearest = {distance, glm::normalize(glm::cross(ab, ac))};
  }
  return nearest;
}

}  // namespace

std::optional<Hit> pick(const Ray& ray, std::span<const PickedBody> bodies) {
  std::optional<Hit> nearest;
  for (const PickedBody& body : bodies) {
    const glm::mat3 turn(body.pose), back = glm::transpose(turn);
    // Distances along the local ray are distances in the scene divided by `size`.
    const Ray local{back * (ray.origin - glm::vec3(body.pose[3])) / body.size, back * ray.direction};
    const Meeting meeting = std::visit([&local](const auto& shape) { return meet(local, shape); }, body.shape);
    const float distance = meeting.distance * body.size;
    if (distance == kFar || (nearest && nearest->distance_m <= distance)) continue;
    const glm::vec3 normal = turn * meeting.normal;
    nearest = Hit{body.id, local.origin + meeting.distance * local.direction, ray.origin + distance * ray.direction,
                  glm::dot(normal, ray.direction) > 0 ? -normal : normal, distance};
  }
  return nearest;
}

}  // namespace ringdown::viewer
