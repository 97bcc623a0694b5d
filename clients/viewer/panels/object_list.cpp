#include "clients/viewer/panels/object_list.h"

#include <algorithm>

namespace ringdown::viewer {
namespace {

// A small button that stays lit while it is on. Returns true when it was pressed.
bool toggle(const char* label, bool on, ImU32 lit, const Skin& skin, const char* tip) {
  if (on) {
    ImGui::PushStyleColor(ImGuiCol_Button, lit);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, lit);
    ImGui::PushStyleColor(ImGuiCol_Text, skin.paper);
  }
  const bool pressed = ImGui::SmallButton(label);
  if (on) ImGui::PopStyleColor(3);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  return pressed;
}

void draw_state(const Skin& skin, const KnownObject& object) {
  if (!object.bank_fault.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, skin.bad);
    ImGui::TextUnformatted("no bank");
    ImGui::PopStyleColor();
  } else if (object.bank) {
    ImGui::TextDisabled("%d modes", object.modes);
  } else {
    ImGui::TextDisabled("%.0f %%", 100 * object.bank_progress);
  }
}

void draw_row(const Skin& skin, const KnownObject& object, ImU32 colour, bool silent, Commands& commands) {
  const float em = ImGui::GetFontSize(), right = ImGui::GetContentRegionMax().x;
  const protocol::ObjectRef ref{object.name, std::nullopt};
  ImGui::PushID(object.name.c_str());
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted("\xE2\x80\xA2");
  ImGui::PopStyleColor();
  ImGui::SameLine();
  if (silent) ImGui::PushStyleColor(ImGuiCol_Text, skin.faint);
  const float width = right - 3.6f * em - ImGui::GetCursorPosX();
  if (ImGui::Selectable(object.name.c_str(), object.name == commands.choice().object, 0, {width, 0})) {
    commands.choose_object(object.name);
  }
  if (silent) ImGui::PopStyleColor();
  if (ImGui::IsItemHovered() && (silent || !object.bank_fault.empty())) {
    ImGui::SetTooltip("%s", object.bank_fault.empty() ? "silent" : object.bank_fault.c_str());
  }
  // A long name takes the place of the number of modes, which the table of modes shows too.
  const bool room = ImGui::GetItemRectMin().x + ImGui::CalcTextSize(object.name.c_str()).x <
                    ImGui::GetWindowPos().x + right - 8.6f * em;
  if (room || !object.bank) {
    ImGui::SameLine(right - 8.4f * em);
    draw_state(skin, object);
  }
  ImGui::SameLine(right - 3.2f * em);
  if (toggle("S", object.solo, skin.good, skin, "Solo: while any object is soloed, the others are silent")) {
    commands.set_solo(object, !object.solo);
  }
  ImGui::SameLine(right - 1.5f * em);
  if (toggle("M", object.mute, skin.warning, skin, "Mute: silent for all listeners")) {
    commands.set_mute(object, !object.mute);
  }
  ImGui::PopID();
}

}  // namespace

void draw_object_list(const Skin& skin, const Model& model, Commands& commands) {
  const auto& objects = model.objects();
  const auto rows = static_cast<float>(std::clamp<std::size_t>(objects.size(), 1, 8));
  if (!ImGui::BeginChild("objects", {0, rows * ImGui::GetTextLineHeightWithSpacing()}, false,
                         ImGuiWindowFlags_NavFlattened))
    return ImGui::EndChild();
  if (objects.empty()) ImGui::TextDisabled("none loaded");
  const bool soloed = std::ranges::any_of(objects, [](const auto& known) { return known.second.solo; });
  std::size_t number = 0;
  for (const auto& [name, object] : objects) {
    draw_row(skin, object, series_colour(number++), object.mute || (soloed && !object.solo), commands);
  }
  ImGui::EndChild();
}

}  // namespace ringdown::viewer
