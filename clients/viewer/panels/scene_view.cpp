#include "clients/viewer/panels/scene_view.h"

#include "clients/viewer/panels/support_panel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::viewer {
namespace {

constexpr float kClick_px = 4;         // a press that moves farther is a drag
constexpr double kPushPerSecond = 4;   // a push moves a body as far as the mouse went in 1/4 s
constexpr float kSpeedOfScene = 0.8F;  // radii of the scene per second
constexpr float kTurn_px = 500;        // a held key turns like a drag of this many pixels per second

Vec3 from_glm(glm::vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

double SceneView::strength_of_click(double seconds) { return std::clamp(seconds / kUsualClick_s, 0.2, 8.0); }

// Sets the camera when another scene has been loaded, or when objects without a scene have come or gone.
void SceneView::follow_scene(const Model& model, float aspect) {
  const Stage::Contents& contents = stage_.contents();
  std::string now = model.scene().description().file.value_or("") + "\n";
  if (contents.items.empty()) return;
  if (!model.scene().description().file) now += std::to_string(contents.items.size());
  if (shown_ == now) return;
  shown_ = now;
  camera_ = stage_.home(model, aspect);
}

void SceneView::draw(const Skin& skin, Model& model, Commands& commands, bool strength_by_time, double now_s,
                     std::optional<double> at_s) {
  origin_ = ImGui::GetCursorScreenPos();
  const ImVec2 available = ImGui::GetContentRegionAvail();
  size_ = {std::max(available.x, 16.0f), std::max(available.y, 16.0f)};
  const Stage::Contents& contents = stage_.update(model, commands, renderer_, skin.dark, now_s, at_s);
  follow_scene(model, size_.x / size_.y);
  const glm::vec3 above = camera_.position_m + camera_.forward() * contents.frame.interest.radius_m * 1.5F;
  commands.choice().drop_m = {above.x, above.y, contents.frame.interest.centre.z + contents.frame.interest.radius_m};
  const std::uint32_t texture = renderer_.render(contents.frame, camera_, static_cast<int>(detail_ * size_.x),
                                                 static_cast<int>(detail_ * size_.y));
  ImGui::InvisibleButton("scene", size_);
  hovered_ = ImGui::IsItemHovered();
  ImGui::GetWindowDrawList()->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture)), origin_,
                                       {origin_.x + size_.x, origin_.y + size_.y}, {0, 1}, {1, 0});
  handle_mouse(model, commands, strength_by_time, now_s);
  mark_support(skin, support_, [this](Vec3 point_m) { return place_of(support_.object(), point_m); });
  draw_press(skin, strength_by_time, now_s);
  if (!hovered_) draw_middle(skin);
  draw_support(skin, origin_, size_, support_);
  place_.draw(skin, origin_, size_, camera_, contents, model, commands);
  touch_.mark(skin, commands.edits().touches(), [&](const std::string& object, Vec3 point_m) {
    const KnownObject* known = model.object(object);
    return place_of(object, known ? 1 / known->scale.size * point_m : point_m);
  });
  touch_.draw(skin, origin_, size_, commands);
}

std::optional<Hit> SceneView::hit_at(ImVec2 at) const {
  const Ray ray =
      camera_.ray_through(at.x - origin_.x, at.y - origin_.y, static_cast<int>(size_.x), static_cast<int>(size_.y));
  return pick(ray, stage_.contents().picked);
}

void SceneView::handle_mouse(const Model& model, Commands& commands, bool strength_by_time, double now_s) {
  const ImGuiIO& io = ImGui::GetIO();
  if (hovered_ && io.MouseWheel != 0) {
    const auto ahead = hit_at({origin_.x + size_.x / 2, origin_.y + size_.y / 2});
    const float away = glm::length(stage_.contents().frame.interest.centre - camera_.position_m);
    camera_.zoom(io.MouseWheel, ahead ? ahead->distance_m : away);
  }
  if (place_.is_dragged()) {
    if (ImGui::IsItemActive()) return place_.drag(io.MousePos, model, commands);
    place_.release();
  }
  if (ImGui::IsItemActivated() && place_.press(io.MousePos)) return;
  if (ImGui::IsItemActivated())
    press_ = Press{io.MousePos, now_s,      hit_at(io.MousePos),
                   io.KeyShift, io.KeyCtrl, touch_.is_open() && !io.KeyShift && !io.KeyCtrl};
  if (!press_) return;
  if (!ImGui::IsItemActive()) return release(model, commands, strength_by_time, now_s);
  const float way = std::hypot(io.MousePos.x - press_->at.x, io.MousePos.y - press_->at.y);
  press_->dragged = press_->dragged || way > kClick_px;
  const bool acts = press_->hit && (press_->pushes || (press_->touches && touch_.takes_drags()));
  const bool looks = !press_->chooses && !acts;
  if (press_->dragged && looks) camera_.look(io.MouseDelta.x, io.MouseDelta.y, static_cast<int>(size_.y));
}

// The way of the mouse since the press, in metres, in the plane of the picture through the point that was hit.
glm::vec3 SceneView::push_of(const Press& press, ImVec2 to) const {
  const float per_pixel = 2 * press.hit->distance_m * std::tan(camera_.field_of_view / 2) / size_.y;
  return per_pixel * ((to.x - press.at.x) * camera_.right() - (to.y - press.at.y) * camera_.up());
}

// Returns the point of an object's surface that was hit; nothing if no object is there.
std::optional<SurfacePoint> SceneView::surface_at(const Hit& hit) const {
  const auto& items = stage_.contents().items;
  if (hit.id >= items.size() || items[hit.id].object.empty()) return std::nullopt;
  const DrawnBody& body = stage_.contents().frame.bodies[hit.id];
  return SurfacePoint{items[hit.id].object, from_glm(body.size * hit.object_point_m), in_body(hit, hit.normal)};
}

// Turns a direction of the scene into the frame of the body that was hit.
Vec3 SceneView::in_body(const Hit& hit, glm::vec3 direction) const {
  return from_glm(glm::transpose(glm::mat3(stage_.contents().frame.bodies[hit.id].pose)) * direction);
}

void SceneView::strike(const Hit& hit, Commands& commands, double factor) {
  const auto at = surface_at(hit);
  if (!at) return;
  commands.choose_object(at->object);
  commands.strike(at->object, at->point_m, at->normal, factor * commands.choice().impulse_ns);
}

// Without a drag a bow moves along the picture.
void SceneView::touch(const Press& press, Commands& commands) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const auto from = surface_at(*press.hit);
  if (!from) return;
  const auto end = hit_at(mouse);
  touch_.touch(*from, in_body(*press.hit, press.dragged ? push_of(press, mouse) : camera_.right()),
               end ? surface_at(*end) : std::nullopt, commands);
}

std::optional<ImVec2> SceneView::place_of(const std::string& object, Vec3 point_m) const {
  const auto& [frame, items, picked] = stage_.contents();
  const auto item = std::ranges::find(items, object, &StageItem::object);
  if (item == items.end()) return std::nullopt;
  const DrawnBody& body = frame.bodies[static_cast<std::size_t>(item - items.begin())];
  const glm::vec3 local = body.size * glm::vec3(point_m.x, point_m.y, point_m.z);
  const auto at =
      camera_.project(glm::vec3(body.pose * glm::vec4(local, 1)), static_cast<int>(size_.x), static_cast<int>(size_.y));
  if (!at) return std::nullopt;
  return ImVec2{origin_.x + at->x, origin_.y + at->y};
}

void SceneView::choose(const Hit& hit, const Model& model) {
  const auto& items = stage_.contents().items;
  const KnownObject* object = hit.id < items.size() ? model.object(items[hit.id].object) : nullptr;
  if (object) support_.toggle_flat(object->name, object->bank, from_glm(hit.object_point_m));
}

// Chooses all triangles of an object that face the camera and lie between the press and `to`: of the object that was
// pressed, or else of the one chosen before.
void SceneView::choose_between(const Press& press, ImVec2 to, const Model& model) {
  const auto& items = stage_.contents().items;
  const bool pressed = press.hit && press.hit->id < items.size();
  const KnownObject* object = model.object(pressed ? items[press.hit->id].object : support_.object());
  if (!object) return;
  const ImVec2 low{std::min(press.at.x, to.x), std::min(press.at.y, to.y)};
  const ImVec2 high{std::max(press.at.x, to.x), std::max(press.at.y, to.y)};
  support_.add(object->name, object->bank, [&](const SupportChoice::Triangle& triangle) {
    std::array<ImVec2, 3> at{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto corner = place_of(object->name, triangle[i]);
      if (!corner || corner->x < low.x || corner->x > high.x || corner->y < low.y || corner->y > high.y) return false;
      at[i] = *corner;
    }
    return faces_camera(at);
  });
}

void SceneView::release(const Model& model, Commands& commands, bool strength_by_time, double now_s) {
  const Press press = *press_;
  press_.reset();
  if (press.chooses && press.dragged) return choose_between(press, ImGui::GetIO().MousePos, model);
  if (!press.hit) return;
  if (press.chooses) return choose(*press.hit, model);
  if (press.touches && (!press.dragged || touch_.takes_drags())) return touch(press, commands);
  if (!press.dragged) {
    return strike(*press.hit, commands, strength_by_time ? strength_of_click(now_s - press.since_s) : 1);
  }
  const auto& items = stage_.contents().items;
  if (!press.pushes || press.hit->id >= items.size() || !items[press.hit->id].body) return;
  const StageItem& what = items[press.hit->id];
  const Vec3 way = from_glm(push_of(press, ImGui::GetIO().MousePos));
  commands.act_once(protocol::ScenePush{*what.body, kPushPerSecond * what.mass_kg * way});
}

void SceneView::draw_press(const Skin& skin, bool strength_by_time, double now_s) const {
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (press_ && press_->chooses) {
    if (press_->dragged) list->AddRect(press_->at, ImGui::GetIO().MousePos, skin.warning, 0, 0, 2);
    return;
  }
  if (!press_ || !press_->hit) return;
  if (press_->dragged && (press_->pushes || (press_->touches && touch_.takes_drags()))) {
    list->AddLine(press_->at, ImGui::GetIO().MousePos, skin.warning, 3);
    list->AddCircleFilled(ImGui::GetIO().MousePos, 6, skin.warning);
  } else if (!press_->dragged) {
    const double strength = strength_by_time && !press_->touches ? strength_of_click(now_s - press_->since_s) : 1;
    list->AddCircle(press_->at, 6 + 4 * static_cast<float>(strength), skin.warning, 0, 2);
  }
}

// Marks the point that the space bar strikes while the mouse is elsewhere.
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
  if (action == Action::touch) {
    place_.end();
    touch_.next();
    return true;
  }
  if (action == Action::copy_support) {
    copy_support(support_);
    return true;
  }
  constexpr std::array kAtMouse = {Action::test_force, Action::choose_support, Action::remove_body, Action::place_body};
  if (std::ranges::find(kAtMouse, action) == kAtMouse.end()) return false;
  const ImVec2 middle{origin_.x + size_.x / 2, origin_.y + size_.y / 2};
  const auto hit = hit_at(hovered_ ? ImGui::GetIO().MousePos : middle);
  if (!hit && action == Action::place_body) place_.end();
  if (!hit) return true;
  if (action == Action::test_force) strike(*hit, commands, 1);
  if (action == Action::choose_support) choose(*hit, model);
  const auto& items = stage_.contents().items;
  const bool is_body = hit->id < items.size() && items[hit->id].body;
  if (action == Action::remove_body && is_body) commands.edits().remove_body(*items[hit->id].body);
  if (action == Action::place_body && is_body) touch_.end(), place_.toggle(*items[hit->id].body);
  return true;
}

void SceneView::move(Action action, double seconds) {
  const auto dt = static_cast<float>(seconds);
  const float way = kSpeedOfScene * dt * stage_.contents().frame.interest.radius_m;
  const float turn = kTurn_px * dt;
  const auto height = static_cast<int>(size_.y);
  const float away = glm::length(stage_.contents().frame.interest.centre - camera_.position_m);
  const auto turn_camera = [&](float right, float down) { camera_.look(turn * right, turn * down, height); };
  switch (action) {
      // clang-format off
    case Action::forward: return camera_.move(way, 0, 0);
    case Action::back: return camera_.move(-way, 0, 0);
    case Action::left: return camera_.move(0, -way, 0);
    case Action::right: return camera_.move(0, way, 0);
    case Action::up: return camera_.move(0, 0, way);
    case Action::down: return camera_.move(0, 0, -way);
    case Action::turn_left: return turn_camera(-1, 0);
    case Action::turn_right: return turn_camera(1, 0);
    case Action::turn_up: return turn_camera(0, -1);
    case Action::turn_down: return turn_camera(0, 1);
    case Action::closer: return camera_.zoom(6 * dt, away);
    case Action::farther: return camera_.zoom(-6 * dt, away);
    default: return;
      // clang-format on
  }
}

}  // namespace ringdown::viewer
