#include "clients/viewer/panels/place_panel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

namespace ringdown::viewer {
namespace {

constexpr float kPlace_em = 22, kPlaceLabel_em = 6;
constexpr double kMinSize = 0.25, kMaxSize = 4;  // as the slider in the left pane
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// Draws a row with a label, its tooltip and three numbers that can be dragged or typed. Returns whether one changed.
bool three_numbers(const char* name, const char* tip, std::array<float, 3>& values, float step, const char* format) {
  label(name, tip, kPlaceLabel_em);
  return ImGui::DragFloat3((std::string("##") + name).c_str(), values.data(), step, 0, 0, format);
}

ImU32 colour_of(const Skin& skin, Handle handle) {
  if (handle == Handle::size) return skin.warning;
  constexpr std::array<ImU32, 3> kColours = {IM_COL32(213, 94, 0, 255), IM_COL32(0, 158, 115, 255),
                                             IM_COL32(86, 180, 233, 255)};  // of Okabe and Ito
  return kColours[static_cast<std::size_t>(handle) % 3];
}

}  // namespace

void PlacePanel::toggle(std::int32_t body) {
  const bool ends = body_ == body;
  end();
  if (!ends) body_ = body;
}

void PlacePanel::draw(const Skin& skin, ImVec2 origin, ImVec2 size, const Camera& camera,
                      const Stage::Contents& contents, const Model& model, Commands& commands) {
  gizmo_.reset();
  if (!body_) return;
  const auto item = std::ranges::find(contents.items, body_, &StageItem::body);
  const auto pose = commands.edits().pose_of(*body_);
  if (item == contents.items.end() || !pose) return end();
  origin_ = origin;
  pose_ = *pose;
  object_ = item->object;
  const PickedBody& picked = contents.picked[static_cast<std::size_t>(item - contents.items.begin())];
  const DrawnMesh& shape = *std::get<const DrawnMesh*>(picked.shape);
  const glm::vec3 middle = picked.size * (shape.low_m + shape.high_m) / 2.0F;
  centre_m_ = pose_.position_m + to_matrix(pose_.rotation) * Vec3{middle.x, middle.y, middle.z};
  const KnownObject* object = model.object(object_);
  size_ = object ? commands.edits().adjustment_of(*object).scale.size : 1;
  const glm::vec3 centre{centre_m_.x, centre_m_.y, centre_m_.z};
  if (glm::dot(centre - camera.position_m, camera.forward()) > Camera::kMinZoom)
    gizmo_.emplace(centre, camera, static_cast<int>(size.x), static_cast<int>(size.y));
  draw_gizmo(skin);
  draw_numbers(skin, size, model, commands);
}

void PlacePanel::draw_gizmo(const Skin& skin) const {
  if (!gizmo_) return;
  const glm::vec2 mouse = in_picture(ImGui::GetIO().MousePos);
  const auto chosen = drag_ ? std::optional(drag_->handle) : gizmo_->handle_at(mouse);
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const Handle handle : kHandles) {
    if (handle == Handle::size && object_.empty()) continue;
    std::vector<ImVec2> line;
    for (const glm::vec2& at : gizmo_->line_of(handle)) line.emplace_back(origin_.x + at.x, origin_.y + at.y);
    if (line.empty()) continue;
    const float width = handle == chosen ? 5.0F : 2.5F;
    list->AddPolyline(line.data(), static_cast<int>(line.size()), colour_of(skin, handle), 0, width);
    if (handle <= Handle::move_z) {
      list->AddCircleFilled(line.back(), 1.8F * width, colour_of(skin, handle));
      list->AddText({line.back().x + 7, line.back().y - 7}, colour_of(skin, handle),
                    kAxes[static_cast<std::size_t>(handle)]);
    }
  }
}

void PlacePanel::set_size(double factor, const Model& model, Commands& commands) const {
  const KnownObject* object = model.object(object_);
  if (!object) return;
  modal::MaterialScale scale = commands.edits().adjustment_of(*object).scale;
  scale.size = std::clamp(factor, kMinSize, kMaxSize);
  commands.edits().change(*object, protocol::SetMaterial{{object_, std::nullopt}, scale}, "Size");
}

void PlacePanel::draw_numbers(const Skin& skin, ImVec2 size, const Model& model, Commands& commands) {
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({origin_.x + em, origin_.y + size.y - em}, 0, {0, 1});
  ImGui::SetNextWindowSize({std::min(kPlace_em * em, size.x - 2 * em), 0});
  ImGui::Begin("Place", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  const KnownBody& body = model.scene().bodies().at(*body_);
  ImGui::PushStyleColor(ImGuiCol_Text, skin.warning);
  ImGui::Text("Place %s", body.name.c_str());
  ImGui::PopStyleColor();
  ImGui::SameLine(ImGui::GetContentRegionAvail().x - 3 * em);
  const bool ends = ImGui::SmallButton("Done");
  std::array<float, 3> at = {static_cast<float>(pose_.position_m.x), static_cast<float>(pose_.position_m.y),
                             static_cast<float>(pose_.position_m.z)};
  if (three_numbers("Position", "Of the origin of the object's mesh, in metres; z is up. Drag, or click and type", at,
                    0.002F, "%.4f m")) {
    commands.edits().place_body(*body_, {{at[0], at[1], at[2]}, pose_.rotation});
  }
  // Numbers that are typed stay as typed, although several triples of angles may stand for one rotation.
  const Rotation typed = rotation_of(angles_), &now = pose_.rotation;
  if (std::abs(typed.x * now.x + typed.y * now.y + typed.z * now.z + typed.w * now.w) < 1 - 1e-9)
    angles_ = angles_of(now);
  std::array<float, 3> degrees{};
  std::ranges::copy(angles_, degrees.begin());
  if (three_numbers("Turn", "Heading about z, then tilt about the new y, then roll about the new x, in degrees",
                    degrees, 0.5F, "%.1f\xC2\xB0")) {
    std::ranges::copy(degrees, angles_.begin());
    commands.edits().place_body(*body_, {pose_.position_m, rotation_of(angles_)});
  }
  auto factor = static_cast<float>(size_);
  if (!object_.empty()) {
    label("Size", "Of the object, and of all bodies that play it: twice as large is an octave lower", kPlaceLabel_em);
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x / 3);
    if (ImGui::DragFloat("##size", &factor, 0.005F, kMinSize, kMaxSize, "\xC3\x97 %.3f", ImGuiSliderFlags_AlwaysClamp))
      set_size(static_cast<double>(factor), model, commands);
  }
  if (!body.fixed && !model.scene().paused())
    ImGui::TextWrapped("The scene runs, so the body falls on. F5 pauses the scene.");
  ImGui::End();
  if (ends) end();
}

bool PlacePanel::press(ImVec2 at) {
  const auto handle = gizmo_ ? gizmo_->handle_at(in_picture(at)) : std::nullopt;
  if (!handle || (*handle == Handle::size && object_.empty())) return false;
  drag_ = Drag{*handle, in_picture(at), *gizmo_, pose_, centre_m_, size_};
  return true;
}

void PlacePanel::drag(ImVec2 to, const Model& model, Commands& commands) {
  const Gizmo::Change change = drag_->gizmo.change_by(drag_->handle, drag_->from, in_picture(to));
  if (drag_->handle == Handle::size) {
    if (std::clamp(drag_->size * static_cast<double>(change.size), kMinSize, kMaxSize) != size_)
      set_size(drag_->size * static_cast<double>(change.size), model, commands);
    return;
  }
  const ringdown::Pose pose = changed(drag_->pose, drag_->centre_m, change);
  if (!(pose == pose_)) commands.edits().place_body(*body_, pose);
}

std::optional<ImVec2> PlacePanel::middle_of(Handle handle) const {
  const auto line = gizmo_ ? gizmo_->line_of(handle) : std::vector<glm::vec2>();
  if (line.empty()) return std::nullopt;
  const glm::vec2 middle = line.size() == 2 ? (line[0] + line[1]) / 2.0F : line[line.size() / 2];
  return ImVec2{origin_.x + middle.x, origin_.y + middle.y};
}

}  // namespace ringdown::viewer
