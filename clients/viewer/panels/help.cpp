#include "clients/viewer/panels/help.h"

#include "clients/viewer/keys.h"

#include <string>

namespace ringdown::viewer {
namespace {

void draw_keys(const Skin& skin, const char* heading, Pane pane) {
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, skin.focus);
  ImGui::TextUnformatted(heading);
  ImGui::PopStyleColor();
  for (const Binding& binding : bindings()) {
    if (binding.pane != pane) continue;
    ImGui::TextUnformatted(std::string(binding.key).c_str());
    ImGui::SameLine(4.5f * ImGui::GetFontSize());
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x);
    ImGui::TextUnformatted(std::string(binding.sentence).c_str());
    ImGui::PopTextWrapPos();
  }
}

}  // namespace

bool draw_help(const Skin& skin) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize();
  const ImVec2 size{std::min(whole.x - 2 * em, 76 * em), std::min(whole.y - 2 * em, 42 * em)};
  ImGui::SetNextWindowPos({whole.x / 2, whole.y / 2}, 0, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowFocus();
  constexpr auto kFlags = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  bool open = true;
  if (ImGui::Begin("Keys", &open, kFlags)) {
    ImGui::TextWrapped(
        "Mouse in the scene: drag to look, wheel to come closer, click a surface to strike it there (held longer, "
        "harder), shift and drag to push a body. Letters that two panes share are the focused pane's.");
    ImGui::Separator();
    if (ImGui::BeginTable("keys", 3, ImGuiTableFlags_SizingStretchSame)) {
      draw_keys(skin, "Everywhere", Pane::any);
      draw_keys(skin, "In the scene", Pane::scene);
      draw_keys(skin, "In the sound", Pane::sound);
      ImGui::EndTable();
    }
  }
  ImGui::End();
  ImGui::PopStyleVar();
  return open;
}

}  // namespace ringdown::viewer
