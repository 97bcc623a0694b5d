// The picture of the object: drawn by the viewer's renderer, turned by the mouse, struck where it is clicked.
// Every call needs the window's OpenGL context to be current. [UI]
#pragma once

#include "clients/plugin/window/shown_body.h"
#include "clients/viewer/render/picking.h"
#include "clients/viewer/render/scene_renderer.h"
#include "engine/base/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace ringdown::plugin {

class BodyView {
 public:
  // Fails where the driver has no OpenGL 3.3.
  static Result<BodyView> create();

  void show(std::shared_ptr<const ShownBody> body);

  // How the object moves and glows in the next picture.
  struct Look {
    float glow = 0;        // 0 ... 1
    std::size_t mode = 0;  // the mode in which it moves
    float swing = 0;       // -1 ... 1: how far, as a share of what looks well
  };
  // Returns the name of a texture that holds the picture; 0 if the driver refuses it. It is valid until the next call.
  std::uint32_t draw(const Look& look, int width, int height);

  void turn(float right, float down);  // by pixels of a drag
  void zoom(float steps);              // of the wheel

  // Returns the point of the object at a pixel of the last picture, as in camera.h.
  [[nodiscard]] std::optional<viewer::Hit> hit(float x, float y) const;
  // Returns the pixel at which a point of the object is seen; nothing if the object hides it.
  [[nodiscard]] std::optional<glm::vec2> pixel_of(const Vec3& point_m) const;

 private:
  explicit BodyView(viewer::SceneRenderer renderer) : renderer_(std::move(renderer)) {}
  [[nodiscard]] viewer::Camera camera() const;
  [[nodiscard]] viewer::Sphere around() const;

  viewer::SceneRenderer renderer_;
  std::shared_ptr<const ShownBody> body_;
  viewer::MeshId mesh_ = 0;
  viewer::Displacement displacement_;
  std::size_t displaced_mode_ = 0;
  float yaw_ = -2.0F, height_ = 0.5F, distance_ = 1;  // angles in rad; 1: the whole object fills the picture
  int width_ = 1, height_px_ = 1;
};

}  // namespace ringdown::plugin
