// The handles at a body that the mouse drags to move, turn and size it: three axes of the scene, three rings about
// them, and a square. Pure geometry in pixels of the picture, whose size on the screen does not depend on the distance.
// [any]
//
//   const Gizmo gizmo(centre_m, camera, width, height);
//   if (const auto handle = gizmo.handle_at(mouse)) ...          // the button goes down
//   const Gizmo::Change change = gizmo.change_by(*handle, from, to);  // while the mouse drags
#pragma once

#include "clients/viewer/render/camera.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace ringdown::viewer {

enum class Handle : std::uint8_t { move_x, move_y, move_z, turn_x, turn_y, turn_z, size };
inline constexpr std::array kHandles = {Handle::move_x, Handle::move_y, Handle::move_z, Handle::turn_x,
                                        Handle::turn_y, Handle::turn_z, Handle::size};

class Gizmo {
 public:
  static constexpr float kRadius = 0.13F;  // of the rings, as a share of the picture's height
  static constexpr float kGrip_px = 7;     // how near the mouse has to be to a handle's line
  static constexpr float kMaxFactor = 20;  // of the size, by one drag

  // `centre_m` is the place in the scene about which the body turns.
  Gizmo(glm::vec3 centre_m, const Camera& camera, int width, int height);

  // Returns the line of a handle in the picture: an axis, the half of a ring that faces the camera, or the outline of
  // the square. Empty if a part of the line lies behind the camera.
  [[nodiscard]] std::vector<glm::vec2> line_of(Handle handle) const;

  // Returns the handle whose line is nearest to a point of the picture, if it is within reach.
  [[nodiscard]] std::optional<Handle> handle_at(glm::vec2 at) const;

  // How a drag from one point of the picture to another changes the body: the body turns about the centre, then moves.
  struct Change {
    glm::vec3 move_m{0};
    glm::quat turn{1, 0, 0, 0};
    float size = 1;  // factor
  };
  [[nodiscard]] Change change_by(Handle handle, glm::vec2 from, glm::vec2 to) const;

 private:
  [[nodiscard]] Ray ray(glm::vec2 at) const { return camera_.ray_through(at.x, at.y, width_, height_); }
  [[nodiscard]] std::optional<glm::vec2> place_of(glm::vec3 point_m) const {
    return camera_.project(point_m, width_, height_);
  }
  [[nodiscard]] std::vector<glm::vec3> points_of(Handle handle) const;
  [[nodiscard]] float way_along(glm::vec3 axis, glm::vec2 at) const;
  [[nodiscard]] float angle_about(glm::vec3 axis, glm::vec2 from, glm::vec2 to) const;

  glm::vec3 centre_m_;
  Camera camera_;
  int width_, height_;
  float radius_m_;
};

}  // namespace ringdown::viewer
