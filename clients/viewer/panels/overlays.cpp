#include "clients/viewer/panels/overlays.h"

#include "clients/viewer/keys.h"
#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <string>

namespace ringdown::viewer {
namespace {

constexpr float kKeyWidth_em = 6.5f;  // "ctrl+delete", and a gap

// The keys of a pane for which `listed` holds.
template <class Listed>
void draw_keys(const Skin& skin, const char* heading, Pane pane, Listed listed) {
  ImGui::PushStyleColor(ImGuiCol_Text, skin.focus);
  ImGui::TextUnformatted(heading);
  ImGui::PopStyleColor();
  for (const Binding& binding : bindings()) {
    if (binding.pane != pane || !listed(binding)) continue;
    const float left = ImGui::GetCursorPosX();
    ImGui::TextUnformatted(std::string(binding.key).c_str());
    ImGui::SameLine();
    ImGui::SetCursorPosX(left + kKeyWidth_em * ImGui::GetFontSize());
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x);
    ImGui::TextUnformatted(std::string(binding.sentence).c_str());
    ImGui::PopTextWrapPos();
  }
}

// Draws sentences in a frame in the middle of a pane.
void draw_advice(const Skin& skin, ImU32 frame, ImVec2 origin, ImVec2 size, const std::string& sentences) {
  const float em = ImGui::GetFontSize();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float wrap = std::min(0.8f * size.x, 30 * em);
  const ImVec2 extent = ImGui::CalcTextSize(sentences.c_str(), nullptr, false, wrap);
  const ImVec2 at{origin.x + (size.x - extent.x) / 2, origin.y + (size.y - extent.y) / 2};
  list->AddRectFilled({at.x - em, at.y - em}, {at.x + extent.x + em, at.y + extent.y + em}, skin.paper, 6);
  list->AddRect({at.x - em, at.y - em}, {at.x + extent.x + em, at.y + extent.y + em}, frame, 6);
  list->AddText(ImGui::GetFont(), em, at, skin.text, sentences.c_str(), nullptr, wrap);
}

}  // namespace

std::string scene_note(const std::string& name, double time_s, double duration_s, bool paused) {
  const bool ended = duration_s > 0 && time_s >= duration_s;
  const std::string clock = duration_s > 0 ? formatted("{:.1f} s of {:g} s", std::min(time_s, duration_s), duration_s)
                                           : formatted("{:.1f} s", time_s);
  return name + "   " + clock + (ended ? "   ended (F6: restart)" : "") + (paused ? "   paused (F5)" : "");
}

void draw_notes(const Skin& skin, ImVec2 origin, ImVec2 size, const KnownScene& scene,
                std::optional<double> shown_at_s) {
  const float em = ImGui::GetFontSize();
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (const auto& file = scene.description().file) {
    const std::string note =
        scene_note(std::filesystem::path(*file).stem(), shown_at_s.value_or(scene.reported_time_s()),
                   scene.description().duration_s, scene.paused());
    list->AddText(ImGui::GetFont(), em, {origin.x + em, origin.y + 0.7f * em}, skin.text, note.c_str(), nullptr,
                  std::max(size.x - 2 * em, em));
  }
  list->AddText({origin.x + em, origin.y + size.y - 1.7f * em}, skin.faint, "F1: keys");
}

void draw_welcome(const Skin& skin, ImVec2 origin, ImVec2 size, const Model& model, bool is_connected) {
  const bool is_empty = model.status() && model.status()->objects == 0 && model.objects().empty();
  if (!is_connected || !is_empty || model.scene().description().file) return;
  draw_advice(skin, skin.focus, origin, size,
              "Nothing is loaded yet. Choose a scene or an object at the left, or drop a mesh, a bank or a scene onto "
              "this window. Then click an object to strike it; F1 shows the keys.");
}

void draw_connection(const Skin& skin, ImVec2 origin, ImVec2 size, const ConnectionState& state) {
  if (state.kind == ConnectionState::Kind::connected) return;
  draw_advice(skin, skin.warning, origin, size, state.sentence);
}

std::optional<double> drag_splitter(const char* name, float x, double share, double direction) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({x - 3, 0});
  ImGui::SetNextWindowSize({6, whole.y});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::InvisibleButton(name, {6, whole.y});
  if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  std::optional<double> dragged;
  if (ImGui::IsItemActive()) {
    dragged = std::clamp(share + direction * static_cast<double>(ImGui::GetIO().MouseDelta.x / whole.x), 0.08, 0.55);
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
  return dragged;
}

bool draw_help(const Skin& skin) {
  const ImVec2 whole = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize();
  const ImVec2 size{std::min(whole.x - 2 * em, 82 * em), std::min(whole.y - 2 * em, 44 * em)};
  ImGui::SetNextWindowPos({whole.x / 2, whole.y / 2}, 0, {0.5f, 0.5f});
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowFocus();
  constexpr auto kFlags = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  bool open = true;
  if (ImGui::Begin("Keys", &open, kFlags)) {
    ImGui::TextWrapped(
        "Mouse in the scene: drag to look, wheel to come closer, click a surface to strike it there (hold longer to "
        "strike harder), shift and drag to push a body, ctrl and click or drag to choose a support. If a letter has "
        "two meanings, the focused pane decides.");
    ImGui::Separator();
    if (ImGui::BeginTable("keys", 3, ImGuiTableFlags_SizingStretchSame)) {
      const auto is_sign = [](const Binding& binding) { return binding.key.size() == 1; };
      const auto is_any = [](const Binding&) { return true; };
      ImGui::TableNextColumn();
      draw_keys(skin, "Everywhere", Pane::any, std::not_fn(is_sign));
      ImGui::Spacing();
      draw_keys(skin, "In the sound", Pane::sound, is_any);
      ImGui::TableNextColumn();
      draw_keys(skin, "Everywhere: the chosen object", Pane::any, is_sign);
      ImGui::TableNextColumn();
      draw_keys(skin, "In the scene", Pane::scene, is_any);
      ImGui::EndTable();
    }
  }
  ImGui::End();
  ImGui::PopStyleVar();
  return open;
}

}  // namespace ringdown::viewer
