// Draws a scene with OpenGL 3.3 into a texture of its own: bodies, ground, soft shadow, glow, flashes, outline.
//
//   Result<SceneRenderer> renderer = SceneRenderer::create();      // with a current context
//   const MeshId bell = renderer->add_mesh(shaded_mesh(bank));     // once
//   const std::uint32_t texture = renderer->render(frame, camera, width, height);
//   ImGui::Image(reinterpret_cast<ImTextureID>(texture), size, {0, 1}, {1, 0});  // row 0 of a texture is the lowest
//
// Every call, and the destructor, in the thread in which the context of create() is current. render() leaves
// framebuffer 0 bound, depth test, blending and face culling off, no program and no vertex array; the viewport is the
// caller's to set.
#pragma once

#include "clients/viewer/render/picture_file.h"
#include "clients/viewer/render/scene_frame.h"
#include "engine/base/result.h"

#include <cstdint>
#include <memory>

namespace ringdown::viewer {

class SceneRenderer {
 public:
  static constexpr int kMaxSide = 8192;  // pixels; what is larger is drawn smaller, as is what the driver cannot do

  // Fails when the context is older than OpenGL 3.3, or its compiler refuses the shaders.
  static Result<SceneRenderer> create();
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;
  ~SceneRenderer();

  // Uploads a mesh. Its number is never given to another one.
  MeshId add_mesh(const DrawnMesh& mesh);
  // Bodies that still name it draw nothing. A number that is not there is ignored.
  void remove_mesh(MeshId mesh);

  // The texture's name: RGBA, opaque, already in sRGB, to be shown as it is. It is the renderer's, and good until the
  // next render(). 0 when the driver cannot give a framebuffer of that size. Sides are at least 1.
  std::uint32_t render(const SceneFrame& frame, const Camera& camera, int width, int height);

  // The picture that render() drew last; empty before the first. Waits for the driver.
  [[nodiscard]] Image read_pixels() const;

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::viewer
