#include "clients/viewer/panels/scene_view.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr float kClick_px = 4;         // a button that moves farther drags
constexpr double kPushPerSecond = 4;   // a push makes a body move the way of the mouse in a quarter of a second
constexpr float kSpeedOfScene = 0.8F;  // radii of the scene a second
constexpr float kTurn_px = 500;        // a second, as a drag of so many pixels

Vec3 from_glm(glm::vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

double SceneView::strength_of_hold(double seconds) { return std::clamp(seconds / kUsualHold_s, 0.2, 8.0); }

// A scene that was loaded is seen from its own camera; objects that come are shown all.
void SceneView::follow_scene(const Model& model, float aspect) {
  const Stage::Set& set = stage_.last();
  std::string now = model.scene().description().file.value_or("") + "\n";
  if (set.staged.empty()) return;
  if (!model.scene().description().file) now += std::to_string(set.staged.size());
  if (shown_ == now) return;
  shown_ = now;
  camera_ = stage_.home(model, aspect);
}

void SceneView::draw(const Skin& skin, Model& model, Commands& commands, bool strength_by_time, double now_s,
                     std::optional<double> at_s) {
  origin_ = ImGui::GetCursorScreenPos();
  const ImVec2 available = ImGui::GetContentRegionAvail();
  size_ = {std::max(available.x, 16.0f), std::max(available.y, 16.0f)};
  const Stage::Set& set = stage_.set(model, commands, renderer_, skin.dark, now_s, at_s);
  follow_scene(model, size_.x / size_.y);
  const glm::vec3 above = camera_.position_m + camera_.forward() * set.frame.interest.radius_m * 1.5F;
  commands.choice().drop_m = {above.x, above.y, set.frame.interest.centre.z + set.frame.interest.radius_m};
  const std::uint32_t texture =
      renderer_.render(set.frame, camera_, static_cast<int>(detail_ * size_.x), static_cast<int>(detail_ * size_.y));
  ImGui::InvisibleButton("scene", size_);
  hovered_ = ImGui::IsItemHovered();
  ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), origin_,
                                       {origin_.x + size_.x, origin_.y + size_.y}, {0, 1}, {1, 0});
  handle_mouse(commands, strength_by_time, now_s);
  draw_press(skin, strength_by_time, now_s);
  if (!hovered_) draw_middle(skin);
}

std::optional<Hit> SceneView::hit_at(ImVec2 place) const {
  const Ray ray = camera_.ray_through(place.x - origin_.x, place.y - origin_.y, static_cast<int>(size_.x),
                                      static_cast<int>(size_.y));
  return pick(ray, stage_.last().picked);
}

void SceneView::handle_mouse(Commands& commands, bool strength_by_time, double now_s) {
  const ImGuiIO& io = ImGui::GetIO();
  if (hovered_ && io.MouseWheel != 0) {
    const auto ahead = hit_at({origin_.x + size_.x / 2, origin_.y + size_.y / 2});
    const float away = glm::length(stage_.last().frame.interest.centre - camera_.position_m);
    camera_.zoom(io.MouseWheel, ahead ? ahead->distance_m : away);
  }
  if (ImGui::IsItemActivated()) press_ = Press{io.MousePos, now_s, hit_at(io.MousePos), io.KeyShift};
  if (!press_) return;
  if (!ImGui::IsItemActive()) return release(commands, strength_by_time, now_s);
  const float way = std::hypot(io.MousePos.x - press_->at.x, io.MousePos.y - press_->at.y);
  press_->dragged = press_->dragged || way > kClick_px;
  const bool pushes = press_->pushes && press_->hit;
  if (press_->dragged && !pushes) camera_.look(io.MouseDelta.x, io.MouseDelta.y, static_cast<int>(size_.y));
}

// What the mouse went, in the plane through the point that was taken, in metres.
glm::vec3 SceneView::push_of(const Press& press, ImVec2 to) const {
  const float per_pixel = 2 * press.hit->distance_m * std::tan(camera_.field_of_view / 2) / size_.y;
  return per_pixel * ((to.x - press.at.x) * camera_.right() - (to.y - press.at.y) * camera_.up());
}

void SceneView::strike(const Hit& hit, Commands& commands, double factor) {
  const auto& staged = stage_.last().staged;
  if (hit.id >= staged.size()) return;
  const Staged& what = staged[hit.id];
  if (what.object.empty()) return;
  const DrawnBody& body = stage_.last().frame.bodies[hit.id];
  const glm::vec3 normal = glm::transpose(glm::mat3(body.pose)) * hit.normal;
  commands.choose_object(what.object);
  commands.strike(what.object, from_glm(body.size * hit.object_point_m), from_glm(normal),
                  factor * commands.choice().impulse_ns);
}

void SceneView::release(Commands& commands, bool strength_by_time, double now_s) {
  const Press press = *press_;
  press_.reset();
  if (!press.hit) return;
  if (!press.dragged) {
    return strike(*press.hit, commands, strength_by_time ? strength_of_hold(now_s - press.since_s) : 1);
  }
  const auto& staged = stage_.last().staged;
  if (!press.pushes || press.hit->id >= staged.size() || !staged[press.hit->id].body) return;
  const Staged& what = staged[press.hit->id];
  const Vec3 way = from_glm(push_of(press, ImGui::GetIO().MousePos));
  commands.push(*what.body, kPushPerSecond * what.mass_kg * way);
}

void SceneView::draw_press(const Skin& skin, bool strength_by_time, double now_s) const {
  if (!press_ || !press_->hit) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (press_->pushes && press_->dragged) {
    list->AddLine(press_->at, ImGui::GetIO().MousePos, skin.warning, 3);
    list->AddCircleFilled(ImGui::GetIO().MousePos, 6, skin.warning);
  } else if (!press_->dragged) {
    const double strength = strength_by_time ? strength_of_hold(now_s - press_->since_s) : 1;
    list->AddCircle(press_->at, 6 + 4 * static_cast<float>(strength), skin.warning, 0, 2);
  }
}

// Where the space bar strikes when no mouse is there.
void SceneView::draw_middle(const Skin& skin) const {
  const ImVec2 middle{origin_.x + size_.x / 2, origin_.y + size_.y / 2};
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddLine({middle.x - 7, middle.y}, {middle.x + 7, middle.y}, skin.faint);
  list->AddLine({middle.x, middle.y - 7}, {middle.x, middle.y + 7}, skin.faint);
}

bool SceneView::perform(Action action, Model& model, Commands& commands) {
  if (action == Action::home) {
    camera_ = stage_.home(model, size_.x / size_.y);
    return true;
  }
  if (action != Action::test_force) return false;
  const ImVec2 middle{origin_.x + size_.x / 2, origin_.y + size_.y / 2};
  if (const auto hit = hit_at(hovered_ ? ImGui::GetIO().MousePos : middle)) strike(*hit, commands, 1);
  return true;
}

void SceneView::move(Action action, double seconds) {
  const auto dt = static_cast<float>(seconds);
  const float way = kSpeedOfScene * dt * stage_.last().frame.interest.radius_m;
  const float turn = kTurn_px * dt;
  const auto height = static_cast<int>(size_.y);
  const float away = glm::length(stage_.last().frame.interest.centre - camera_.position_m);
  switch (action) {
    case Action::forward:
      return camera_.move(way, 0, 0);
    case Action::back:
      return camera_.move(-way, 0, 0);
    case Action::left:
      return camera_.move(0, -way, 0);
    case Action::right:
      return camera_.move(0, way, 0);
    case Action::up:
      return camera_.move(0, 0, way);
    case Action::down:
      return camera_.move(0, 0, -way);
    case Action::turn_left:
      return camera_.look(-turn, 0, height);
    case Action::turn_right:
      return camera_.look(turn, 0, height);
    case Action::turn_up:
      return camera_.look(0, -turn, height);
    case Action::turn_down:
      return camera_.look(0, turn, height);
    case Action::closer:
      return camera_.zoom(6 * dt, away);
    case Action::farther:
      return camera_.zoom(-6 * dt, away);
    default:
      return;
  }
}

}  // namespace ringdown::viewer
