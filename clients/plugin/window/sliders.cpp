#include "clients/plugin/window/sliders.h"

#include "clients/plugin/parameter_text.h"
#include "clients/viewer/panels/skin.h"

#include <imgui.h>

#include <cmath>
#include <string>

namespace ringdown::plugin {
namespace {

constexpr double kHold_s = 1.5;
constexpr double kLoud_db = 0;  // from here on the meter warns

// ImGui takes the text that stands on a slider as a pattern of printf.
std::string as_pattern(const std::string& text) {
  std::string pattern;
  for (const char letter : text) pattern += letter == '%' ? std::string("%%") : std::string(1, letter);
  return pattern;
}

bool is_shown(const ParameterInfo& info, Parameter parameter) {
  return info.scale != Scale::output && parameter != Parameter::object &&
         parameter != Parameter::mallet;  // the browser and the row of mallets show these
}

}  // namespace

void Sliders::draw(Edits& edits) {
  for (std::size_t group = 0; group < kGroups; ++group) {
    ImGui::Spacing();
    ImGui::TextDisabled("%s", kGroupInfo[group].name);
    ImGui::Separator();
    for (std::size_t i = 0; i < kParameters; ++i) {
      const auto parameter = static_cast<Parameter>(i);
      if (static_cast<std::size_t>(kParameterInfo[i].group) != group || !is_shown(kParameterInfo[i], parameter))
        continue;
      ImGui::PushID(static_cast<int>(i));
      draw_one(parameter, edits);
      draw_field(parameter, edits);
      ImGui::PopID();
    }
  }
}

void Sliders::draw_one(Parameter parameter, Edits& edits) {
  const auto number = static_cast<std::size_t>(parameter);
  const ParameterInfo& info = kParameterInfo[number];
  float value = edits.values()[parameter];
  if (info.scale == Scale::toggle) {
    bool on = value > 0.5F;
    if (ImGui::Checkbox(info.name, &on)) edits.set(parameter, on ? 1 : 0);
  } else {
    ImGui::SetNextItemWidth(0.5F * ImGui::GetContentRegionAvail().x);
    const std::string text = as_pattern(text_of(number, static_cast<double>(value)));
    ImGuiSliderFlags flags = ImGuiSliderFlags_NoInput | ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat;
    if (info.scale == Scale::logarithmic) flags |= ImGuiSliderFlags_Logarithmic;
    const bool moved = ImGui::SliderFloat(info.name, &value, info.min, info.max, text.c_str(), flags);
    const bool stepped = info.scale == Scale::whole || info.scale == Scale::choice;
    if (ImGui::IsItemActivated()) edits.begin(parameter);
    if (moved) edits.move(parameter, static_cast<double>(stepped ? std::round(value) : value));
    if (ImGui::IsItemDeactivated()) edits.end(parameter);
  }
  ImGui::OpenPopupOnItemClick("type");
  if (ImGui::IsItemHovered() && !ImGui::IsItemActive()) ImGui::SetTooltip("%s", info.meaning);
}

void Sliders::draw_field(Parameter parameter, Edits& edits) {
  const auto number = static_cast<std::size_t>(parameter);
  if (!ImGui::BeginPopup("type")) return;
  if (ImGui::IsWindowAppearing()) {
    const std::string text = text_of(number, static_cast<double>(edits.values()[parameter]));
    typed_[text.copy(typed_.data(), typed_.size() - 1)] = 0;
    ImGui::SetKeyboardFocusHere();
  }
  const auto flags = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll;
  if (ImGui::InputText("##value", typed_.data(), typed_.size(), flags)) {
    if (const auto value = value_of(number, typed_.data())) edits.set(parameter, *value);
    ImGui::CloseCurrentPopup();
  }
  if (ImGui::Button("Default")) {
    edits.set(parameter, static_cast<double>(kParameterInfo[number].standard));
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void LevelMeter::follow(double level_db, double now_s) {
  level_db_ = level_db;
  if (level_db < held_db_ && now_s - held_at_s_ < kHold_s) return;
  held_db_ = level_db;
  held_at_s_ = now_s;
}

void LevelMeter::draw(float width, float height) const {
  const viewer::Skin skin = viewer::make_skin(true);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto place = [&](double db) {
    return corner.x + width * static_cast<float>(std::clamp((db - kLow_db) / (kHigh_db - kLow_db), 0.0, 1.0));
  };
  const float bottom = corner.y + height;
  list.AddRectFilled(corner, {corner.x + width, bottom}, skin.paper);
  list.AddRectFilled(corner, {place(level_db_), bottom}, level_db_ < kLoud_db ? skin.good : skin.bad);
  for (const double db : {-60.0, -40.0, -20.0, 0.0})
    list.AddLine({place(db), corner.y}, {place(db), bottom}, skin.grid);
  if (held_db_ > kLow_db) {
    list.AddLine({place(held_db_), corner.y}, {place(held_db_), bottom}, skin.text, 2);
  }
  ImGui::Dummy({width, height});
  const auto peak = static_cast<std::size_t>(Parameter::level);
  ImGui::TextDisabled("Peak %s", held_db_ > kLow_db ? text_of(peak, held_db_).c_str() : "silent");
}

}  // namespace ringdown::plugin
