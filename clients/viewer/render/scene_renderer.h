// Draws a scene with OpenGL 3.3 into a texture of its own: bodies, ground, soft shadow, glow, flashes, outline.
//
//   Result<SceneRenderer> renderer = SceneRenderer::create();      // with a current context
//   const MeshId bell = renderer->add_mesh(shaded_mesh(bank));     // once
//   const std::uint32_t texture = renderer->render(frame, camera, width, height);
//   ImGui::Image(reinterpret_cast<ImTextureID>(texture), size, {0, 1}, {1, 0});  // row 0 of a texture is the lowest
//
// Every call, and the destructor, must run on the thread in which the context of create() is current. render() leaves
// framebuffer 0 bound, depth test, blending and face culling off, and no program or vertex array bound; the caller sets
// the viewport afterwards.
#pragma once

#include "clients/viewer/render/picture_file.h"
#include "clients/viewer/render/scene_frame.h"
#include "engine/base/result.h"

#include <cstdint>
#include <memory>

namespace ringdown::viewer {

class SceneRenderer {
 public:
  static constexpr int kMaxSide = 8192;  // pixels; larger pictures are drawn at this size, or at the driver's limit

  // Fails when the context is older than OpenGL 3.3, or its compiler refuses the shaders.
  static Result<SceneRenderer> create();
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;
  ~SceneRenderer();

  // Uploads a mesh. Its number is never reused.
  MeshId add_mesh(const DrawnMesh& mesh);
  // Bodies that still name the mesh are not drawn. An unknown number is ignored.
  void remove_mesh(MeshId mesh);

  // Returns the name of a texture: RGBA, opaque, encoded as sRGB, to be shown unchanged. The renderer owns the texture,
  // which is valid until the next render(). Returns 0 when the driver has no framebuffer of that size. Sides below 1
  // count as 1.
  std::uint32_t render(const SceneFrame& frame, const Camera& camera, int width, int height);

  // Returns the picture drawn by the last render(); empty before the first. Waits for the driver.
  [[nodiscard]] Image read_pixels() const;

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Chooses the resolution of drawing if drawing is slow: software rendering of every pixel would make the window
// sluggish.
class DetailControl {
 public:
  static constexpr double kSlow_s = 0.045, kQuick_s = 0.018;  // mean frame times beyond which the detail changes
  static constexpr double kCoarsest = 0.35;
  static constexpr int kFrames = 8;  // minimum number of frames between two changes

  void observe(double frame_s);  // call after every frame with its duration

  // Returns the share of the picture's width and height to draw, from kCoarsest to 1.
  [[nodiscard]] double detail() const { return detail_; }

 private:
  double detail_ = 1, sum_s_ = 0;
  int frames_ = 0;
};

}  // namespace ringdown::viewer
