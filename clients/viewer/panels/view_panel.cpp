#include "clients/viewer/panels/view_panel.h"

#include "clients/viewer/camera_listener.h"
#include "clients/viewer/panels/skin.h"
#include "clients/viewer/render/placing.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace ringdown::viewer {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180;
constexpr float kMinField_degrees = 5, kMaxField_degrees = 120;
constexpr float kViewLabel_em = 5;
constexpr float kStep_m = 0.005F, kStep_degrees = 0.3F;

void draw_camera(Camera& camera) {
  label("Camera", "The place of the camera in the scene: x, y and z in metres; z is up", kViewLabel_em);
  ImGui::DragFloat3("##camera", &camera.position_m.x, kStep_m, 0, 0, "%.3f");
  label("Looks", "Heading, from x towards y, and angle above the horizon, in degrees", kViewLabel_em);
  std::array<float, 2> looks = {camera.yaw / kDegree, camera.pitch / kDegree};
  if (ImGui::DragFloat2("##looks", looks.data(), kStep_degrees, 0, 0, "%.1f\xC2\xB0")) {
    camera.yaw = looks[0] * kDegree;
    camera.pitch = std::clamp(looks[1] * kDegree, -Camera::kSteepest, Camera::kSteepest);
  }
  label("Field", "The vertical field of view, in degrees", kViewLabel_em);
  float field = camera.field_of_view / kDegree;
  if (ImGui::DragFloat("##field", &field, kStep_degrees, kMinField_degrees, kMaxField_degrees, "%.1f\xC2\xB0",
                       ImGuiSliderFlags_AlwaysClamp))
    camera.field_of_view = field * kDegree;
}

void draw_listener(const Camera& camera, Edits& edits) {
  if (ImGui::SmallButton("Put here")) edits.set_listener(listener_of(camera));
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Puts the listener where the camera is now, and leaves it there");
  if (!edits.listener()) return;
  ImGui::SameLine();
  if (ImGui::SmallButton("No listener")) return edits.set_listener(std::nullopt);
  ringdown::Pose pose = *edits.listener();
  std::array<float, 3> at = {static_cast<float>(pose.position_m.x), static_cast<float>(pose.position_m.y),
                             static_cast<float>(pose.position_m.z)};
  label("Listener", "The place of the listener's head in the scene: x, y and z in metres", kViewLabel_em);
  bool changes = ImGui::DragFloat3("##listener", at.data(), kStep_m, 0, 0, "%.3f");
  if (changes) pose.position_m = {at[0], at[1], at[2]};
  const Angles angles = angles_of(pose.rotation);
  std::array<float, 2> faces = {static_cast<float>(angles[0]), static_cast<float>(-angles[1])};
  label("Faces", "Heading, from x towards y, and angle above the horizon, in degrees", kViewLabel_em);
  if (ImGui::DragFloat2("##faces", faces.data(), kStep_degrees, 0, 0, "%.1f\xC2\xB0")) {
    const float elevation = std::clamp(faces[1], -Camera::kSteepest / kDegree, Camera::kSteepest / kDegree);
    pose.rotation = rotation_of({static_cast<double>(faces[0]), static_cast<double>(-elevation), 0});
    changes = true;
  }
  if (changes) edits.set_listener(pose);
}

}  // namespace

void draw_view(Camera& camera, Commands& commands, bool& listens) {
  if (!ImGui::CollapsingHeader("Camera and listener")) return;
  draw_camera(camera);
  ImGui::Checkbox("Listen from the camera", &listens);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("F3. Otherwise the listener stays where you put it, or there is none");
  if (!listens) draw_listener(camera, commands.edits());
}

}  // namespace ringdown::viewer
