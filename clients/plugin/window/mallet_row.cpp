#include "clients/plugin/window/mallet_row.h"

#include "clients/plugin/mallets.h"
#include "clients/viewer/panels/skin.h"
#include "engine/base/formatted.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace ringdown::plugin {
namespace {

constexpr float kPicture = 2.6F;  // heights of the font
constexpr float kPi = 3.14159265F;

// The heads, as seen: radius in heights of the font, and colour.
struct Head {
  float radius;
  ImU32 colour;
};
constexpr ImU32 kWool = IM_COL32(96, 132, 196, 255), kCord = IM_COL32(214, 200, 166, 255),
                kRubber = IM_COL32(150, 66, 58, 255), kWood = IM_COL32(190, 138, 84, 255),
                kBrass = IM_COL32(212, 174, 76, 255), kShaft = IM_COL32(172, 132, 92, 255),
                kHair = IM_COL32(232, 226, 210, 255), kDark = IM_COL32(0, 0, 0, 90),
                kShine = IM_COL32(255, 255, 255, 150);
constexpr std::array<Head, kMallets> kHeads = {
    {{0, 0}, {0.72F, kWool}, {0.6F, kCord}, {0.52F, kRubber}, {0.44F, kWood}, {0.36F, kBrass}, {0, 0}}};

// Draws in a square whose corners are (0, 0) and (1, 1), y downwards.
struct Pen {
  ImVec2 corner;
  float size;
  [[nodiscard]] ImVec2 operator()(float x, float y) const { return {corner.x + x * size, corner.y + y * size}; }
};

// The force of a blow that is known in advance: a half sine over time.
void draw_force(ImDrawList& list, const Pen& pen, const viewer::Skin& skin) {
  list.AddLine(pen(0.05F, 0.85F), pen(0.95F, 0.85F), skin.faint);
  std::array<ImVec2, 21> curve;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const float way = static_cast<float>(i) / (curve.size() - 1);
    curve[i] = pen(0.25F + 0.5F * way, 0.85F - 0.7F * std::sin(kPi * way));
  }
  list.AddPolyline(curve.data(), static_cast<int>(curve.size()), skin.text, 0, 2);
}

void draw_bow(ImDrawList& list, const Pen& pen, float unit) {
  list.AddLine(pen(0.06F, 0.94F), pen(0.94F, 0.2F), kHair, 0.12F * unit);
  list.AddBezierCubic(pen(0.02F, 0.82F), pen(0.3F, 0.66F), pen(0.6F, 0.4F), pen(0.94F, 0.1F), kShaft, 0.16F * unit);
  list.AddLine(pen(0.02F, 0.8F), pen(0.08F, 0.96F), kWood, 0.22F * unit);   // frog
  list.AddLine(pen(0.94F, 0.08F), pen(0.95F, 0.22F), kWood, 0.14F * unit);  // tip
}

// Lines over the head: the windings of yarn and cord, the grain of wood.
void draw_texture(ImDrawList& list, Mallet mallet, ImVec2 middle, float radius) {
  const auto chord = [&](float across, float turn) {
    const float half = std::sqrt(std::max(0.0F, 1 - across * across)), c = std::cos(turn), s = std::sin(turn);
    const auto at = [&](float along) {
      return ImVec2{middle.x + radius * (c * along - s * across), middle.y + radius * (s * along + c * across)};
    };
    list.AddLine(at(-half), at(half), kDark, 1.2F);
  };
  if (mallet == Mallet::wood) {
    for (const float across : {-0.5F, 0.0F, 0.5F}) chord(across, -0.8F);
  } else if (mallet == Mallet::yarn) {
    for (const float turn : {0.2F, 1.3F, 2.4F}) {
      for (const float across : {-0.55F, 0.0F, 0.55F}) chord(across, turn);
    }
  } else if (mallet == Mallet::cord) {
    for (const float across : {-0.7F, -0.35F, 0.0F, 0.35F, 0.7F}) chord(across, 0.8F);
  }
}

void draw_picture(ImDrawList& list, Mallet mallet, const Pen& pen, const viewer::Skin& skin) {
  const float unit = ImGui::GetFontSize();
  if (mallet == Mallet::as_struck) return draw_force(list, pen, skin);
  if (mallet == Mallet::bow) return draw_bow(list, pen, unit);
  const auto& [radius, colour] = kHeads[static_cast<std::size_t>(mallet)];
  const ImVec2 middle = pen(0.68F, 0.32F);
  list.AddLine(pen(0.02F, 0.98F), middle, kShaft, 0.16F * unit);
  list.AddCircleFilled(middle, radius * unit, colour);
  draw_texture(list, mallet, middle, radius * unit);
  const bool shines = mallet == Mallet::brass || mallet == Mallet::rubber;
  const float aside = 0.35F * radius * unit;
  if (shines) list.AddCircleFilled({middle.x - aside, middle.y - aside}, 0.25F * radius * unit, kShine);
}

std::string tip_of(Mallet mallet) {
  const MalletInfo& info = kMalletInfo[static_cast<std::size_t>(mallet)];
  if (mallet == Mallet::as_struck) return "A blow as long as \"Contact time\" says, or the note map's bow";
  if (mallet == Mallet::bow) return "A bow, drawn while the key is down; breath, expression and pressure control it";
  return formatted("A mallet of {:.0f} g that feels the surface: {}", 1000 * info.mass_kg, info.name);
}

}  // namespace

float mallet_row_height() { return (kPicture + 1.3F) * ImGui::GetFontSize(); }

void draw_mallet_row(float width, Edits& edits) {
  const viewer::Skin skin = viewer::make_skin(true);
  const float unit = ImGui::GetFontSize(), height = mallet_row_height(), cell = width / kMallets;
  const auto chosen = static_cast<std::size_t>(edits.values()[Parameter::mallet]);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < kMallets; ++i) {
    if (i > 0) ImGui::SameLine(0, 0);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton(kMalletInfo[i].name, {cell, height}) && i != chosen) {
      edits.set(Parameter::mallet, static_cast<double>(i));
    }
    const bool hovered = ImGui::IsItemHovered();
    const ImVec2 end{corner.x + cell, corner.y + height};
    if (i == chosen || hovered) list.AddRectFilled(corner, end, i == chosen ? skin.grid : skin.paper, 4);
    const float size = kPicture * unit;
    draw_picture(list, static_cast<Mallet>(i), {{corner.x + (cell - size) / 2, corner.y + 0.15F * unit}, size}, skin);
    const float text = ImGui::CalcTextSize(kMalletInfo[i].name).x;
    list.AddText({corner.x + (cell - text) / 2, end.y - 1.15F * unit}, i == chosen ? skin.text : skin.faint,
                 kMalletInfo[i].name);
    if (hovered) ImGui::SetTooltip("%s", tip_of(static_cast<Mallet>(i)).c_str());
  }
}

}  // namespace ringdown::plugin
