// Picking: the nearest body that a ray hits, and the point and normal there. Pure geometry. [any]
//
//   const std::optional<Hit> hit = pick(camera.ray_through(x, y, width, height), bodies);
#pragma once

#include "clients/viewer/render/camera.h"
#include "clients/viewer/render/drawn_mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

namespace ringdown::viewer {

struct BoxShape {
  glm::vec3 size_m{1};  // edges; centred at the origin of the body's frame
};
struct SphereShape {
  float radius_m = 1;
};

struct PickedBody {
  std::uint32_t id = 0;
  std::variant<const DrawnMesh*, BoxShape, SphereShape> shape;  // the mesh must outlive the call; never null
  glm::mat4 pose{1};                                            // as in DrawnBody
  float size = 1;                                               // as in DrawnBody; above 0
};

struct Hit {
  std::uint32_t id = 0;
  glm::vec3 object_point_m{0};  // in the frame of the mesh, before `size` is applied
  glm::vec3 point_m{0};         // in the scene
  glm::vec3 normal{0};          // in the scene: unit normal of the flat triangle, on the side of the ray's origin
  float distance_m = 0;         // from the ray's origin
};

// Returns the nearest hit ahead of the ray's origin. A ray that begins inside a body hits its surface from inside.
// Displacements by a mode are ignored: bodies are picked in their rest shape.
std::optional<Hit> pick(const Ray& ray, std::span<const PickedBody> bodies);

}  // namespace ringdown::viewer
