// The viewpoint of the scene. Lengths in metres, angles in radians; z is up.
//
// Positions in a picture are in pixels from the top left corner, x to the right and y down; the centre of the first
// pixel is at (0.5, 0.5). Mouse positions of a window have the same origin. A camera is a plain value. [any]
//
//   Camera camera = Camera::from({0, -2, 1}, {0, 0, 0.3F}, glm::radians(50.0F));
//   camera.look(dx, dy, height);                                  // while the mouse drags
//   camera.zoom(wheel, hit ? hit->distance_m : 1);                // hit: pick(camera.ray_through(middle), ...)
//   const Ray ray = camera.ray_through(mouse_x, mouse_y, width, height);
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace ringdown::viewer {

struct Ray {
  glm::vec3 origin{0};
  glm::vec3 direction{0, 1, 0};  // unit
};

struct Sphere {
  glm::vec3 centre{0};
  float radius_m = 1;
};

struct Camera {
  static constexpr float kSteepest = 1.55F;           // largest |pitch|, just short of straight up or down
  static constexpr float kMinZoom = 0.02F;            // metres that zoom() keeps from the surface ahead
  static constexpr float kMaxZoom = 5000;             // metres from there: /listener takes places within 10,000 m
  static constexpr float kZoomStep = 0.85F;           // one wheel step multiplies the distance by this
  static constexpr float kDefaultFieldOfView = 0.8F;  // about 46 degrees

  glm::vec3 position_m{0, -2, 1};
  float yaw = 1.5707963F;                     // 0 looks along x, pi / 2 along y
  float pitch = 0;                            // above the horizon
  float field_of_view = kDefaultFieldOfView;  // vertical

  // Returns a camera at `position_m` that looks at `target_m`, or along y if both are equal. A field of view of 0 means
  // the default.
  static Camera from(glm::vec3 position_m, glm::vec3 target_m, float field_of_view = kDefaultFieldOfView);
  // Scenes are composed for a picture of kComposedAspect (width over height). Returns the vertical field of view with
  // which a picture of `aspect` shows everything that the composed picture shows: `field_of_view` itself, or more in a
  // narrower picture.
  static float fitted_field_of_view(float field_of_view, float aspect);
  static constexpr float kComposedAspect = 1.6F;
  // Returns a camera that sees the whole sphere from the front (-y) and somewhat above, in a picture of this aspect.
  static Camera showing(Sphere scene, float aspect = 1.6F);

  // Turns the camera by a mouse drag: to the right for positive `dx`, down for positive `dy`, through the angle that
  // those pixels span in the middle of a picture `height` pixels high.
  void look(float dx, float dy, int height);
  // Moves forward by wheel steps (backward when negative). `distance_m` is the distance to the surface in the middle of
  // the picture; however many steps are taken, the camera stays kMinZoom to kMaxZoom in front of that surface.
  void zoom(float steps, float distance_m);
  // Moves along the camera's own forward and right axes, and straight up.
  void move(float forward_m, float right_m, float up_m);

  [[nodiscard]] glm::vec3 forward() const;  // unit
  [[nodiscard]] glm::vec3 right() const;    // unit, level
  [[nodiscard]] glm::vec3 up() const;       // unit, upward in the picture
  [[nodiscard]] glm::mat4 view() const;     // scene -> camera (x right, y up, -z forward)
  // Returns the map from camera to clip space of OpenGL (z in -1 ... 1). The far plane lies kGround radii beyond the
  // centre of `scene`, so that the ground around the scene is visible; the near plane lies at 1/5000 of that distance.
  [[nodiscard]] glm::mat4 projection(float aspect, Sphere scene) const;
  static constexpr float kGround = 12;

  [[nodiscard]] Ray ray_through(float x, float y, int width, int height) const;
  // Returns the position of a point in the picture, which may lie outside the edges; nothing for a point behind the
  // camera.
  [[nodiscard]] std::optional<glm::vec2> project(glm::vec3 point_m, int width, int height) const;
};

}  // namespace ringdown::viewer
