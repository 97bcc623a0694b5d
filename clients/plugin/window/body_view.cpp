#include "clients/plugin/window/body_view.h"

#include "clients/viewer/render/look.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::plugin {
namespace {

constexpr float kTurnPerPixel = 0.01F, kLowest = -1.2F, kHighest = 1.5F;  // rad
constexpr float kZoomStep = 0.9F, kNearest = 0.25F, kFarthest = 4;
constexpr float kSwing = 0.04F;   // of the object's diagonal
constexpr float kHidden = 0.03F;  // of the radius: by so much a point may lie behind the surface that is seen

glm::vec3 to_glm(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

}  // namespace

Result<BodyView> BodyView::create() {
  auto renderer = viewer::SceneRenderer::create();
  if (!renderer) return fail(renderer);
  return BodyView(std::move(*renderer));
}

void BodyView::show(std::shared_ptr<const ShownBody> body) {
  renderer_.remove_mesh(mesh_);
  body_ = std::move(body);
  mesh_ = renderer_.add_mesh(body_->mesh);
  displacement_ = nullptr;
}

viewer::Sphere BodyView::around() const {
  const glm::vec3 low = body_->mesh.low_m, high = body_->mesh.high_m;
  return {(low + high) / 2.0F, std::max(glm::length(high - low) / 2, 1e-4F)};
}

viewer::Camera BodyView::camera() const {
  const viewer::Sphere scene = around();
  const float aspect = static_cast<float>(width_) / static_cast<float>(height_px_);
  const float field = viewer::Camera::kDefaultFieldOfView;
  const float narrow = std::min(1.0F, aspect);  // a narrow picture needs a greater distance
  const float away = distance_ * scene.radius_m / (narrow * std::sin(field / 2));
  const glm::vec3 way{std::cos(height_) * std::cos(yaw_), std::cos(height_) * std::sin(yaw_), std::sin(height_)};
  return viewer::Camera::from(scene.centre + away * way, scene.centre, field);
}

std::uint32_t BodyView::draw(const Look& look, int width, int height) {
  width_ = std::max(width, 1);
  height_px_ = std::max(height, 1);
  if (!body_) return 0;
  viewer::SceneFrame frame;
  frame.interest = around();
  viewer::DrawnBody drawn;
  drawn.mesh = mesh_;
  drawn.colour = viewer::material_colour(body_->material);
  drawn.glow = look.glow;
  if (look.swing != 0 && look.mode < body_->frequencies_hz.size()) {
    if (!displacement_ || displaced_mode_ != look.mode) displacement_ = body_->displacement(look.mode);
    displaced_mode_ = look.mode;
    drawn.displacement = displacement_;
    drawn.displacement_m = kSwing * look.swing * 2 * frame.interest.radius_m;
  }
  frame.bodies.push_back(std::move(drawn));
  frame.statics.push_back({.position_m = {0, 0, body_->mesh.low_m.z}});
  return renderer_.render(frame, camera(), width_, height_px_);
}

void BodyView::turn(float right, float down) {
  yaw_ -= kTurnPerPixel * right;
  height_ = std::clamp(height_ + kTurnPerPixel * down, kLowest, kHighest);
}

void BodyView::zoom(float steps) {
  distance_ = std::clamp(distance_ * std::pow(kZoomStep, steps), kNearest, kFarthest);
}

std::optional<viewer::Hit> BodyView::hit(float x, float y) const {
  if (!body_) return std::nullopt;
  const std::array bodies = {viewer::PickedBody{.shape = &body_->mesh}};
  return viewer::pick(camera().ray_through(x, y, width_, height_px_), bodies);
}

std::optional<glm::vec2> BodyView::pixel_of(const Vec3& point_m) const {
  if (!body_) return std::nullopt;
  const viewer::Camera seen_from = camera();
  const auto pixel = seen_from.project(to_glm(point_m), width_, height_px_);
  if (!pixel) return std::nullopt;
  const auto first = hit(pixel->x, pixel->y);
  const float away_m = glm::length(to_glm(point_m) - seen_from.position_m);
  if (first && first->distance_m < away_m - kHidden * around().radius_m) return std::nullopt;
  return pixel;
}

}  // namespace ringdown::plugin
