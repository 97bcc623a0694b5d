// One picture's worth of scene: what the application hands to the renderer sixty times a second. Plain data. Scene
// frame, metres, z up; colours are sRGB, 0 ... 1. [any]
#pragma once

#include "clients/viewer/render/camera.h"
#include "clients/viewer/render/drawn_mesh.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace ringdown::viewer {

using MeshId = std::uint32_t;  // from SceneRenderer::add_mesh; 0 is none and draws nothing

struct DrawnBody {
  std::uint32_t id = 0;  // the application's own
  MeshId mesh = 0;
  glm::mat4 pose{1};  // object's frame -> scene: a rotation and a translation
  float size = 1;     // the mesh is drawn this many times as large, about the origin of its frame
  glm::vec3 colour{0.62F};
  float glow = 0;         // 0 ... 1: how strongly it rings; seen as brightness, so without colour too
  bool selected = false;  // outlined, also where something hides it
  // Drawn at position + displacement_m * (*displacement)[point], before size and pose; normals follow. Nothing: at
  // rest.
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

// A contact, for a moment: a spot of light and a ring that widens.
struct Flash {
  glm::vec3 point_m{0};
  glm::vec3 normal{0, 0, 1};  // unit: the ring lies across it; away from the surface
  float strength = 1;         // 0 ... 1: how large and bright
  float age = 0;              // 0 when it was struck ... 1 when it is gone
};

enum class Theme { dark, light };

// Unit: where the key light comes from, in every scene: from above, left of and before who looks along y.
inline glm::vec3 towards_light() { return {-0.48F, -0.36F, 0.8F}; }

struct SceneFrame {
  Theme theme = Theme::dark;
  // What the light, its shadow and the ground's fading are fitted to: hold all that moves, and no more than that. What
  // is outside is drawn, but throws no shadow.
  Sphere interest;
  std::vector<DrawnBody> bodies;
  std::vector<DrawnStatic> statics;
  std::vector<Flash> flashes;
};

}  // namespace ringdown::viewer
