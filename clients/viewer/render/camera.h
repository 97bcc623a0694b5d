// Where the scene is seen from. Lengths in metres, angles in radians; z is up.
//
// A picture has its origin in the top left corner, x to the right and y down, in pixels; the centre of the first pixel
// is at (0.5, 0.5). So are the mouse positions of a window. A plain value without state elsewhere. [any]
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
  static constexpr float kSteepest = 1.55F;           // |pitch|: never quite straight up or down
  static constexpr float kMinZoom = 0.02F;            // metres that zoom() leaves to what is ahead
  static constexpr float kZoomStep = 0.85F;           // of the distance, that one step of the wheel leaves
  static constexpr float kDefaultFieldOfView = 0.8F;  // about 46 degrees

  glm::vec3 position_m{0, -2, 1};
  float yaw = 1.5707963F;                     // 0 looks along x, pi / 2 along y
  float pitch = 0;                            // above the horizon
  float field_of_view = kDefaultFieldOfView;  // vertical

  // At `position_m`, looking at `target_m`; along y when both are the same point. A field of view of 0 is the default
  // one.
  static Camera from(glm::vec3 position_m, glm::vec3 target_m, float field_of_view = kDefaultFieldOfView);
  // The vertical field of view of a picture of that aspect (width over height) that shows all that one of
  // `field_of_view` and of kComposedAspect does: the same, and in a narrower picture a larger one.
  static float fitted_field_of_view(float field_of_view, float aspect);
  static constexpr float kComposedAspect = 1.6F;
  // Sees the whole sphere from in front (-y) and somewhat above, in a picture of that aspect (width over height).
  static Camera showing(Sphere scene, float aspect = 1.6F);

  // The mouse was dragged: to the right turns the camera to the right, down turns it down, as far as those pixels are
  // apart in the middle of a picture `height` pixels high.
  void look(float dx, float dy, int height);
  // Wheel steps; positive goes forward. `distance_m`: how far away that is which is under the middle of the picture;
  // however many steps, the camera stays kMinZoom in front of it.
  void zoom(float steps, float distance_m);
  // Along the camera's own forward and right, and straight up.
  void move(float forward_m, float right_m, float up_m);

  [[nodiscard]] glm::vec3 forward() const;  // unit
  [[nodiscard]] glm::vec3 right() const;    // unit, level
  [[nodiscard]] glm::vec3 up() const;       // unit: up in the picture
  [[nodiscard]] glm::mat4 view() const;     // scene -> camera (x right, y up, -z forward)
  // camera -> clip space of OpenGL (z in -1 ... 1). Near and far are chosen so that `scene` and the ground about it are
  // seen: far is kGround radii beyond its centre, near 1/5000 of far.
  [[nodiscard]] glm::mat4 projection(float aspect, Sphere scene) const;
  static constexpr float kGround = 12;

  [[nodiscard]] Ray ray_through(float x, float y, int width, int height) const;
  // Where a point is in the picture, perhaps outside its edges; nothing for one that is not before the camera.
  [[nodiscard]] std::optional<glm::vec2> project(glm::vec3 point_m, int width, int height) const;
};

}  // namespace ringdown::viewer
