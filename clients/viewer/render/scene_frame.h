// Everything the renderer needs to draw one picture of the scene; the application makes a new SceneFrame for each.
// Plain data in the scene's frame: metres, z up; colours are sRGB, 0 ... 1. [any]
#pragma once

#include "clients/viewer/render/camera.h"
#include "clients/viewer/render/drawn_mesh.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace ringdown::viewer {

using MeshId = std::uint32_t;  // from SceneRenderer::add_mesh; 0: no mesh, nothing is drawn

struct DrawnBody {
  std::uint32_t id = 0;  // chosen by the application
  MeshId mesh = 0;
  glm::mat4 pose{1};  // object's frame -> scene: a rotation and a translation
  float size = 1;     // scales the mesh about the origin of its frame
  glm::vec3 colour{0.62F};
  float glow = 0;         // 0 ... 1: how loud the body is, shown as brightness
  bool selected = false;  // draws an outline, also where another body hides this one
  // A point is drawn at position + displacement_m * (*displacement)[point], before size and pose are applied; normals
  // follow. Empty: the body is drawn at rest.
  Displacement displacement;
  float displacement_m = 0;
};

enum class StaticShape { plane, box };

struct DrawnStatic {
  StaticShape shape = StaticShape::plane;
  glm::vec3 position_m{0};     // a box's centre; a plane's point nearest to the origin
  glm::quat turn{1, 0, 0, 0};  // w x y z; a plane faces its turned z axis
  glm::vec3 size_m{0};         // a box's edges
};

// A contact, shown briefly as a spot of light and a widening ring.
struct Flash {
  glm::vec3 point_m{0};
  glm::vec3 normal{0, 0, 1};  // unit, out of the surface; the ring lies across it
  float strength = 1;         // 0 ... 1: size and brightness
  float age = 0;              // 0 at the contact ... 1 when the flash has faded
};

enum class Theme { dark, light };

// The direction towards the key light, unit: from above, and from the left behind a viewer who looks along y.
inline glm::vec3 towards_light() { return {-0.48F, -0.36F, 0.8F}; }

struct SceneFrame {
  Theme theme = Theme::dark;
  // The sphere to which the light, its shadow and the fading of the ground are fitted. It should hold everything that
  // moves, and little more. Bodies outside are drawn but cast no shadow.
  Sphere interest;
  std::vector<DrawnBody> bodies;
  std::vector<DrawnStatic> statics;
  std::vector<Flash> flashes;
};

}  // namespace ringdown::viewer
