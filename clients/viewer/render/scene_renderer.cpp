#include "clients/viewer/render/scene_renderer.h"

#include "clients/viewer/render/gl.h"
#include "clients/viewer/render/gl_shapes.h"
#include "clients/viewer/render/look.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

// One picture is drawn in six passes. (1) The shadow map: depth of bodies and static boxes as seen from the light.
// (2) The mask: the selected body's silhouette, if there is one. Into the multisampled picture go (3) the background,
// (4) bodies and static boxes, lit with the shadow map, (5) the ground planes with their grid, blended, and the
// flashes of contacts. (6) The last pass resolves the samples, draws the outline around the mask, and encodes as sRGB.
namespace ringdown::viewer {
namespace {

struct Programs {
  GlProgram body, flat, ground, background, flash, last;
};

Result<Programs> link_programs() {
  Programs made;
  struct Wanted {
    GlProgram& program;
    const char* name;
    const std::string &vertex, &fragment;
  };
  const Wanted all[] = {{made.body, "body", body_vertex_shader(), body_shader()},
                        {made.flat, "flat", body_vertex_shader(), flat_shader()},
                        {made.ground, "ground", ground_vertex_shader(), ground_shader()},
                        {made.background, "background", whole_vertex_shader(), background_shader()},
                        {made.flash, "flash", flash_vertex_shader(), flash_shader()},
                        {made.last, "last", whole_vertex_shader(), last_shader()}};
  for (const Wanted& wanted : all) {
    Result<GlProgram> program = GlProgram::link(wanted.name, wanted.vertex, wanted.fragment);
    if (!program) return fail(program);
    wanted.program = std::move(*program);
  }
  return made;
}

void set_tests(bool depth, bool blend) {
  (depth ? glEnable : glDisable)(GL_DEPTH_TEST);
  (blend ? glEnable : glDisable)(GL_BLEND);
}

// Whatever drew before, ImGui for one, may have left the context in any state.
void reset_context() {
  for (const GLenum off : {GL_CULL_FACE, GL_SCISSOR_TEST, GL_FRAMEBUFFER_SRGB, GL_STENCIL_TEST}) glDisable(off);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glBlendEquation(GL_FUNC_ADD);
  glActiveTexture(GL_TEXTURE0);
  glBindSampler(0, 0);
  glBindSampler(1, 0);
}

}  // namespace

struct SceneRenderer::State {
  explicit State(Programs linked) : programs(std::move(linked)) {}

  Programs programs;
  ShadowMap shadow;
  std::optional<PictureTargets> targets;
  GlObject frame_buffer = make_buffer(), no_corners = make_vertex_array();
  FlashQuads flashes;
  GlMesh cube{box_mesh(glm::vec3(1))};
  std::map<MeshId, GlMesh> meshes;
  MeshId last_mesh = 0;

  bool fit_targets(int width, int height);
  void upload_frame(const FrameBlock& block) const;
  void draw_body(const GlProgram& program, const DrawnBody& body);
  void draw_box(const GlProgram& program, const DrawnStatic& box);
  void draw_shadow_map(const SceneFrame& frame, const glm::mat4& light);
  void draw_bodies(const SceneFrame& frame, const FrameBlock& block);
  void draw_ground(const SceneFrame& frame);
  bool draw_mask(const SceneFrame& frame, const FrameBlock& block);
  void draw_last(bool outlined) const;
};

bool SceneRenderer::State::fit_targets(int width, int height) {
  GLint max = kMaxSide;
  for (const GLenum limit : {GL_MAX_TEXTURE_SIZE, GL_MAX_RENDERBUFFER_SIZE}) {
    GLint drivers = 0;
    glGetIntegerv(limit, &drivers);
    max = std::min(max, drivers);
  }
  width = std::clamp(width, 1, max);
  height = std::clamp(height, 1, max);
  if (!targets || targets->width != width || targets->height != height) {
    targets.reset();
    targets.emplace(width, height);
  }
  return targets->complete;
}

void SceneRenderer::State::upload_frame(const FrameBlock& block) const {
  glBindBuffer(GL_UNIFORM_BUFFER, frame_buffer.name());
  glBufferData(GL_UNIFORM_BUFFER, sizeof block, &block, GL_STREAM_DRAW);
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, frame_buffer.name());
}

void SceneRenderer::State::draw_body(const GlProgram& program, const DrawnBody& body) {
  const auto mesh = meshes.find(body.mesh);
  if (mesh == meshes.end()) return;
  program.set("pose", body.pose);
  program.set("size", body.size);
  program.set("displacement", body.displacement ? body.displacement_m : 0.0F);
  mesh->second.draw(body.displacement);
}

void SceneRenderer::State::draw_box(const GlProgram& program, const DrawnStatic& box) {
  const glm::mat4 turned = glm::translate(glm::mat4(1), box.position_m) * glm::mat4_cast(box.turn);
  program.set("pose", glm::scale(turned, box.size_m));
  program.set("size", 1.0F);
  program.set("displacement", 0.0F);
  cube.draw({});
}

void SceneRenderer::State::draw_shadow_map(const SceneFrame& frame, const glm::mat4& light) {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow.framebuffer.name());
  glViewport(0, 0, ShadowMap::kSide, ShadowMap::kSide);
  set_tests(true, false);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_CLAMP);  // bodies between the light and the near end of the map still throw their shadow
  programs.flat.use();
  const glm::mat4 to_clip = glm::scale(glm::translate(glm::mat4(1), glm::vec3(-1)), glm::vec3(2)) * light;
  programs.flat.set("to_clip", to_clip);
  for (const DrawnBody& body : frame.bodies) draw_body(programs.flat, body);
  for (const DrawnStatic& fixed : frame.statics) {
    if (fixed.shape == StaticShape::box) draw_box(programs.flat, fixed);
  }
  glDisable(GL_DEPTH_CLAMP);
}

void SceneRenderer::State::draw_bodies(const SceneFrame& frame, const FrameBlock& block) {
  set_tests(true, false);
  const GlProgram& program = programs.body;
  program.use();
  program.set("to_clip", block.view_projection);
  program.set("shadow_map", 0);
  for (const DrawnBody& body : frame.bodies) {
    program.set("colour", linear_from_srgb(body.colour));
    program.set("glow", std::clamp(body.glow, 0.0F, 1.0F));
    draw_body(program, body);
  }
  program.set("colour", linear_from_srgb(static_colour(frame.theme)));
  program.set("glow", 0.0F);
  for (const DrawnStatic& fixed : frame.statics) {
    if (fixed.shape == StaticShape::box) draw_box(program, fixed);
  }
}

void SceneRenderer::State::draw_ground(const SceneFrame& frame) {
  set_tests(true, true);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  const GlProgram& program = programs.ground;
  program.use();
  program.set("shadow_map", 0);
  program.set("spacing", grid_spacing(frame.interest.radius_m));
  program.set("reach", 6.5F * frame.interest.radius_m);  // the shader fades the ground out before this
  glBindVertexArray(no_corners.name());
  for (const DrawnStatic& fixed : frame.statics) {
    if (fixed.shape != StaticShape::plane) continue;
    program.set("pose", glm::translate(glm::mat4(1), fixed.position_m) * glm::mat4_cast(fixed.turn));
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
}

bool SceneRenderer::State::draw_mask(const SceneFrame& frame, const FrameBlock& block) {
  if (std::none_of(frame.bodies.begin(), frame.bodies.end(), [](const DrawnBody& b) { return b.selected; }))
    return false;
  glBindFramebuffer(GL_FRAMEBUFFER, targets->mask.name());
  set_tests(false, false);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  programs.flat.use();
  programs.flat.set("to_clip", block.view_projection);
  for (const DrawnBody& body : frame.bodies) {
    if (body.selected) draw_body(programs.flat, body);
  }
  return true;
}

void SceneRenderer::State::draw_last(bool outlined) const {
  const int w = targets->width, h = targets->height;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, targets->many.name());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->linear.name());
  glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, targets->last.name());
  set_tests(false, false);
  programs.last.use();
  programs.last.set("picture", 0);
  programs.last.set("mask", 1);
  programs.last.set("outlined", outlined ? 1 : 0);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, targets->mask_texture.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, targets->linear_texture.name());
  glBindVertexArray(no_corners.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

Result<SceneRenderer> SceneRenderer::create() {
  if (!epoxy_is_desktop_gl() || epoxy_gl_version() < 33) {
    const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
    return fail(ErrorKind::refused,
                "the scene is drawn with OpenGL 3.3 or newer, but this driver offers '{}'; use a newer driver, or "
                "Mesa's own with LIBGL_ALWAYS_SOFTWARE=1",
                version ? version : "nothing");
  }
  Result<Programs> programs = link_programs();
  if (!programs) return fail(programs);
  SceneRenderer renderer(std::make_unique<State>(std::move(*programs)));
  glBindFramebuffer(GL_FRAMEBUFFER, 0);  // a framebuffer that stayed bound would take the caller's next picture
  return renderer;
}

SceneRenderer::SceneRenderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

MeshId SceneRenderer::add_mesh(const DrawnMesh& mesh) {
  state_->meshes.try_emplace(++state_->last_mesh, mesh);
  return state_->last_mesh;
}

void SceneRenderer::remove_mesh(MeshId mesh) { state_->meshes.erase(mesh); }

std::uint32_t SceneRenderer::render(const SceneFrame& frame, const Camera& camera, int width, int height) {
  State& s = *state_;
  if (!s.fit_targets(width, height)) return 0;
  const int w = s.targets->width, h = s.targets->height;
  const FrameBlock block = frame_block(frame, camera, static_cast<float>(w) / static_cast<float>(h));
  s.upload_frame(block);
  reset_context();
  s.draw_shadow_map(frame, block.light);

  glViewport(0, 0, w, h);
  const bool outlined = s.draw_mask(frame, block);
  glBindFramebuffer(GL_FRAMEBUFFER, s.targets->many.name());
  glClear(GL_DEPTH_BUFFER_BIT);
  set_tests(false, false);
  s.programs.background.use();
  glBindVertexArray(s.no_corners.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindTexture(GL_TEXTURE_2D, s.shadow.depth.name());
  s.draw_bodies(frame, block);
  glDepthMask(GL_FALSE);
  s.draw_ground(frame);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  s.programs.flash.use();
  s.flashes.draw(frame, camera);
  glDepthMask(GL_TRUE);
  s.draw_last(outlined);

  for (auto& [id, mesh] : s.meshes) mesh.end_frame();
  glBindVertexArray(0);
  glUseProgram(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  return s.targets->last_texture.name();
}

Image SceneRenderer::read_pixels() const {
  if (!state_->targets || !state_->targets->complete) return {};
  Image image{state_->targets->width, state_->targets->height, {}};
  const std::size_t row = std::size_t{4} * static_cast<std::size_t>(image.width);
  image.rgba.resize(row * static_cast<std::size_t>(image.height));
  glBindFramebuffer(GL_FRAMEBUFFER, state_->targets->last.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  const auto rows = static_cast<std::ptrdiff_t>(row);
  for (auto low = image.rgba.begin(), high = image.rgba.end() - rows; low < high; low += rows, high -= rows)
    std::swap_ranges(low, low + rows, high);
  return image;
}

void DetailControl::observe(double frame_s) {
  constexpr double kStep = 0.75;
  sum_s_ += frame_s;
  if (++frames_ < kFrames) return;
  const double mean_s = sum_s_ / kFrames;
  sum_s_ = 0;
  frames_ = 0;
  if (mean_s > kSlow_s) detail_ = std::max(kCoarsest, kStep * detail_);
  if (mean_s < kQuick_s) detail_ = std::min(1.0, detail_ / kStep);
}

}  // namespace ringdown::viewer
