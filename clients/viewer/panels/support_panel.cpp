#include "clients/viewer/panels/support_panel.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

namespace ringdown::viewer {
namespace {

constexpr float kWidth_em = 24;

}  // namespace

bool faces_camera(const std::array<ImVec2, 3>& corners) {
  const auto [a, b, c] = corners;
  return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y) < 0;
}

void mark_support(const Skin& skin, const SupportChoice& choice,
                  const std::function<std::optional<ImVec2>(Vec3)>& place) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImU32 fill = (skin.warning & ~IM_COL32_A_MASK) | (ImU32{0x70} << IM_COL32_A_SHIFT);
  for (const SupportChoice::Triangle& triangle : choice.triangles()) {
    std::array<ImVec2, 3> at{};
    bool seen = true;
    for (std::size_t i = 0; i < 3 && seen; ++i) {
      const auto corner = place(triangle[i]);
      seen = corner.has_value();
      if (corner) at[i] = *corner;
    }
    if (seen && faces_camera(at)) list->AddTriangleFilled(at[0], at[1], at[2], fill);
  }
}

void copy_support(const SupportChoice& choice) {
  if (choice.empty()) return;
  ImGui::SetClipboardText(choice.text().c_str());
  std::fputs(choice.text().c_str(), stdout);
  std::fflush(stdout);
}

void draw_support(const Skin& skin, ImVec2 origin, ImVec2 size, SupportChoice& choice) {
  if (choice.empty()) return;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowPos({origin.x + size.x - em, origin.y + size.y - em}, 0, {1, 1});
  ImGui::SetNextWindowSize({std::min(kWidth_em * em, size.x - 2 * em), 0});
  ImGui::Begin("Support", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::PushStyleColor(ImGuiCol_Text, skin.warning);
  ImGui::Text("Support of %s", choice.object().c_str());
  ImGui::PopStyleColor();
  for (std::size_t kind = 0; kind < SupportChoice::kKinds.size(); ++kind) {
    if (kind > 0) ImGui::SameLine();
    if (ImGui::RadioButton(SupportChoice::kKinds[kind], choice.kind() == kind)) choice.set_kind(kind);
  }
  ImGui::TextWrapped("%s", choice.text().c_str());
  if (ImGui::Button("Copy")) copy_support(choice);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("Copies text for an object file to the clipboard, and prints it");
  ImGui::SameLine();
  if (ImGui::Button("Discard")) choice.clear();
  ImGui::End();
}

}  // namespace ringdown::viewer
