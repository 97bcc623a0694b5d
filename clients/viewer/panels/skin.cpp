#include "clients/viewer/panels/skin.h"

#include <algorithm>
#include <array>

namespace ringdown::viewer {
namespace {

constexpr float kSliderLabel_em = 7.3f;

constexpr std::array<ImU32, 7> kSeries = {
    IM_COL32(86, 180, 233, 255), IM_COL32(230, 159, 0, 255),  IM_COL32(0, 158, 115, 255), IM_COL32(204, 121, 167, 255),
    IM_COL32(213, 94, 0, 255),   IM_COL32(240, 228, 66, 255), IM_COL32(0, 114, 178, 255),
};

void set_dark(ImGuiStyle& style) {
  ImGui::StyleColorsDark(&style);
  auto& c = style.Colors;
  c[ImGuiCol_WindowBg] = {0.09f, 0.10f, 0.11f, 1};
  c[ImGuiCol_ChildBg] = {0.09f, 0.10f, 0.11f, 1};
  c[ImGuiCol_PopupBg] = {0.12f, 0.13f, 0.15f, 0.98f};
  c[ImGuiCol_FrameBg] = {0.16f, 0.17f, 0.19f, 1};
  c[ImGuiCol_TitleBgActive] = {0.13f, 0.14f, 0.16f, 1};
  c[ImGuiCol_Button] = {0.20f, 0.22f, 0.25f, 1};
  c[ImGuiCol_Header] = {0.20f, 0.27f, 0.33f, 1};
  c[ImGuiCol_HeaderHovered] = {0.25f, 0.34f, 0.42f, 1};
  c[ImGuiCol_HeaderActive] = {0.28f, 0.40f, 0.50f, 1};
  c[ImGuiCol_SliderGrab] = {0.16f, 0.42f, 0.57f, 1};  // the number is written across it
  c[ImGuiCol_SliderGrabActive] = {0.20f, 0.52f, 0.70f, 1};
  c[ImGuiCol_CheckMark] = {0.34f, 0.70f, 0.91f, 1};
}

void set_light(ImGuiStyle& style) {
  ImGui::StyleColorsLight(&style);
  auto& c = style.Colors;
  c[ImGuiCol_WindowBg] = {0.96f, 0.96f, 0.95f, 1};
  c[ImGuiCol_ChildBg] = {0.96f, 0.96f, 0.95f, 1};
  c[ImGuiCol_Text] = {0.10f, 0.11f, 0.12f, 1};
  c[ImGuiCol_TextDisabled] = {0.38f, 0.39f, 0.40f, 1};
  c[ImGuiCol_SliderGrab] = {0.55f, 0.77f, 0.91f, 1};
  c[ImGuiCol_SliderGrabActive] = {0.42f, 0.70f, 0.88f, 1};
  c[ImGuiCol_CheckMark] = {0.0f, 0.45f, 0.70f, 1};
}

}  // namespace

Skin make_skin(bool dark) {
  if (dark) {
    return {true,
            IM_COL32(17, 19, 21, 255),
            IM_COL32(255, 255, 255, 26),
            IM_COL32(226, 228, 230, 255),
            IM_COL32(150, 155, 160, 255),
            IM_COL32(86, 180, 233, 255),
            IM_COL32(0, 178, 130, 255),
            IM_COL32(230, 159, 0, 255),
            IM_COL32(230, 92, 60, 255),
            IM_COL32(86, 180, 233, 255)};
  }
  return {false,
          IM_COL32(255, 255, 255, 255),
          IM_COL32(0, 0, 0, 30),
          IM_COL32(26, 28, 30, 255),
          IM_COL32(98, 102, 106, 255),
          IM_COL32(0, 114, 178, 255),
          IM_COL32(0, 125, 90, 255),
          IM_COL32(180, 110, 0, 255),
          IM_COL32(190, 60, 0, 255),
          IM_COL32(0, 114, 178, 255)};
}

ImU32 series_colour(std::size_t i) { return kSeries[i % kSeries.size()]; }

void label(const char* text, const char* tip, float width_em) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  ImGui::SameLine(width_em * ImGui::GetFontSize());
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
}

bool slider(const char* name, const char* tip, double& value, SliderRange range, const char* format) {
  const float em = ImGui::GetFontSize(), gap = 0.3f * em, number_width = 4.9f * em;
  const auto min = static_cast<float>(range.min), max = static_cast<float>(range.max);
  const ImGuiSliderFlags flags =
      ImGuiSliderFlags_AlwaysClamp | (range.logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
  auto shown = static_cast<float>(value);
  ImGui::PushID(name);
  label(name, tip, kSliderLabel_em);
  ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - number_width - gap, em));
  bool changed = ImGui::SliderFloat("##slider", &shown, min, max, "", flags);
  ImGui::SameLine(0, gap);
  ImGui::SetNextItemWidth(number_width);
  const float step = range.logarithmic ? 0.003f * shown : 0.002f * (max - min);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {2, ImGui::GetStyle().FramePadding.y});
  changed =
      ImGui::DragFloat("##number", &shown, step, min, max, format, flags & ~ImGuiSliderFlags_Logarithmic) || changed;
  ImGui::PopStyleVar();
  ImGui::PopID();
  if (changed) value = static_cast<double>(shown);
  return changed;
}

void apply(const Skin& skin, float scale) {
  ImGuiStyle style;
  skin.dark ? set_dark(style) : set_light(style);
  style.WindowRounding = 0;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.ScrollbarRounding = 3;
  style.WindowBorderSize = 0;
  style.FrameBorderSize = skin.dark ? 0.0f : 1.0f;
  style.WindowPadding = {10, 8};
  style.ItemSpacing = {8, 5};
  style.CellPadding = {6, 2};
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
}

}  // namespace ringdown::viewer
