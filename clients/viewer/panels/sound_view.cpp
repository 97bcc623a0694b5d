#include "clients/viewer/panels/sound_view.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::viewer {
namespace {

// Scrolls the table only as far as needed, so that a clicked row stays under the mouse.
void keep_in_sight(std::uint32_t row) {
  const float height = ImGui::GetTextLineHeight() + 2 * ImGui::GetStyle().CellPadding.y;
  const float top = static_cast<float>(row) * height;
  const float shown = ImGui::GetWindowHeight() - 2 * height;  // below the headings
  if (top < ImGui::GetScrollY()) ImGui::SetScrollY(top);
  if (top > ImGui::GetScrollY() + shown) ImGui::SetScrollY(top - shown);
}

bool same(const Adjustment& a, const Adjustment& b) {
  return a.scale == b.scale && a.gain == b.gain && a.range == b.range;
}

void draw_count(const Skin& skin, const char* label, std::int64_t count) {
  ImGui::TextDisabled("%s", label);
  ImGui::SameLine();
  if (count > 0) {
    ImGui::PushStyleColor(ImGuiCol_Text, skin.warning);
    ImGui::Text("%lld", static_cast<long long>(count));
    ImGui::PopStyleColor();
  } else {
    ImGui::TextUnformatted("0");
  }
}

struct Column {
  const char* heading;
  float weight;
  const char* tip;
};
constexpr std::array kColumns = {
    Column{"mode", 0.7f, "Modes by ascending frequency. Click to hear one mode alone"},
    Column{"frequency", 1.2f, "Frequency in the present material and size"},
    Column{"decay", 1.0f, "T60: how long the mode takes to fall by 60 dB"},
    Column{"level", 1.1f, "Initial level of the mode after a blow of 1 N s at the excited node [dB of full scale]"},
};

// The bars of an object: one for each mode, as high as the mode is loud.
BarGroup bars_of(const KnownObject& object, ImU32 colour, const Choice& choice) {
  const bool chosen = object.name == choice.object;
  const double frequency_factor = std::sqrt(modal::lambda_factor(object.scale));
  BarGroup group{object.name, colour, {}};
  const std::size_t count = std::min(object.amplitudes.size(), object.bank->by_frequency.size());
  for (std::size_t rank = 0; rank < count; ++rank) {
    const double hz = object.bank->bank.frequency_hz[object.bank->by_frequency[rank]];
    group.bars.push_back({hz * frequency_factor, object.amplitudes[rank], chosen && rank == choice.mode});
  }
  return group;
}

// Names the colours in one line, so that the table below stays where it is when objects begin or cease to ring. Names
// without room are counted: "+3".
void draw_legend(const Skin& skin, const std::vector<BarGroup>& groups) {
  const float em = ImGui::GetFontSize(), side = 0.6f * em, gap = 0.4f * em;
  const auto width_of = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float right = at.x + ImGui::GetContentRegionAvail().x;
  ImDrawList* list = ImGui::GetWindowDrawList();
  float x = at.x;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::string rest = formatted("+{}", groups.size() - i);
    const float end = x + side + gap + width_of(groups[i].name) + em;
    if (end + (i + 1 < groups.size() ? width_of(rest) : -em) > right) {
      list->AddText({x, at.y}, skin.faint, rest.c_str());
      break;
    }
    const float top = at.y + (ImGui::GetTextLineHeight() - side) / 2;
    list->AddRectFilled({x, top}, {x + side, top + side}, groups[i].colour);
    list->AddText({x + side + gap, at.y}, skin.text, groups[i].name.c_str());
    x = end;
  }
  ImGui::Dummy({right - at.x, ImGui::GetTextLineHeight()});
}

// Draws the chosen object's settings, for a window without the sliders.
void draw_settings(const KnownObject* object, const Commands& commands) {
  if (object) {
    const modal::MaterialScale scale = commands.edits().adjustment_of(*object).scale;
    ImGui::TextWrapped(
        "%s: stiffness \xC3\x97 %.3g, density \xC3\x97 %.3g, material loss \xC3\x97 %.3g, support loss \xC3\x97 %.3g, "
        "test force %.3g N s",
        object->name.c_str(), scale.stiffness, scale.density, scale.beta, scale.alpha, commands.choice().impulse_ns);
  }
  ImGui::TextDisabled("F1: keys");
}

// One row of the table of modes; true when the user clicked it.
bool draw_row(const Skin& skin, int row, const ListedMode& mode, bool chosen) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushID(row);
  ImGui::PushStyleColor(ImGuiCol_Text, mode.selected ? skin.text : skin.faint);
  const bool clicked = ImGui::Selectable(std::to_string(row).c_str(), chosen, ImGuiSelectableFlags_SpanAllColumns);
  ImGui::TableNextColumn();
  mode.frequency_hz > 0 ? ImGui::Text("%.1f Hz", mode.frequency_hz) : ImGui::TextUnformatted("no pitch");
  ImGui::TableNextColumn();
  if (mode.t60_s < 0.1) {
    ImGui::Text("%.3g ms", 1e3 * mode.t60_s);
  } else {
    ImGui::Text("%.3g s", mode.t60_s);
  }
  ImGui::TableNextColumn();
  ImGui::Text("%.1f dB", mode.gain_db);
  ImGui::PopStyleColor();
  ImGui::PopID();
  return clicked;
}

}  // namespace

void SoundView::draw_meters(const Skin& skin, const Model& model, bool tone) const {
  draw_level(skin, "Level", static_cast<float>(model.peak().now), static_cast<float>(model.peak().held));
  const auto& status = model.status();
  const double p99 = status ? status->load_p99 : 0;
  const std::string text = formatted("{:4.1f} %", 100 * model.load().mean);
  draw_share(skin, "DSP load", model.load().mean, p99, text);
  draw_count(skin, "xruns", model.load().xruns);
  ImGui::SameLine();
  draw_count(skin, "  dropped", status ? status->dropped_events : 0);
  ImGui::SameLine();
  draw_count(skin, "  late", status ? status->late_events : 0);
  ImGui::TextDisabled("ringing");
  ImGui::SameLine();
  const auto many = [](int count) { return count == 1 ? "" : "s"; };
  const protocol::NotifyLoad& load = model.load();
  ImGui::Text("%d object%s, %d mode%s", load.sounding_objects, many(load.sounding_objects), load.sounding_modes,
              many(load.sounding_modes));
  if (!tone) return;
  ImGui::SameLine();
  ImGui::PushStyleColor(ImGuiCol_Text, skin.warning);
  ImGui::TextUnformatted("test tone (W)");
  ImGui::PopStyleColor();
}

void SoundView::draw_curves(const Skin& skin, const Model& model, float height) {
  const SoundHistory& sound = model.sound();
  const double rate = std::max(sound.sample_rate_hz(), 1.0);
  sound.last(Spectrum::kFrames, left_, right_);
  mono_.resize(left_.size());
  for (std::size_t i = 0; i < left_.size(); ++i) mono_[i] = (left_[i] + right_[i]) / 2;
  const float width = ImGui::GetContentRegionAvail().x;
  const auto recent = std::min(left_.size(), static_cast<std::size_t>(0.08 * rate));
  draw_oscilloscope(skin, {width, height}, std::span(left_).last(recent), std::span(right_).last(recent), rate);
  draw_spectrum(skin, {width, height}, spectrum_.analyse(mono_), rate / Spectrum::kFrames);
}

const std::vector<ListedMode>& SoundView::modes_of(const KnownObject& object, const Commands& commands) {
  const Adjustment adjustment = commands.edits().adjustment_of(object);
  if (object.bank != listed_ || node_ != commands.choice().node || !same(adjustment, adjustment_)) {
    listed_ = object.bank;
    node_ = commands.choice().node;
    adjustment_ = adjustment;
    modes_ = list_modes(*object.bank, adjustment, node_);
  }
  return modes_;
}

void SoundView::draw_amplitudes(const Skin& skin, Model& model, Commands& commands, float height) {
  std::vector<BarGroup> groups;
  std::vector<const KnownObject*> objects;
  std::size_t number = 0;
  for (const auto& [name, object] : model.objects()) {
    const ImU32 colour = series_colour(number++);
    if (!object.bank || object.amplitudes.empty()) continue;
    groups.push_back(bars_of(object, colour, commands.choice()));
    objects.push_back(&object);
  }
  const Picked picked = draw_bars(skin, {ImGui::GetContentRegionAvail().x, height}, groups);
  if (picked.group >= 0) {
    commands.hear_alone(*objects[static_cast<std::size_t>(picked.group)], static_cast<std::uint32_t>(picked.bar));
  }
  draw_legend(skin, groups);
}

void SoundView::draw_table(const Skin& skin, const KnownObject& object, Commands& commands) {
  const std::vector<ListedMode>& modes = modes_of(object, commands);
  const modal::ModeRange range = commands.edits().adjustment_of(object).range;
  const auto played = static_cast<int>(std::ranges::count(modes, true, &ListedMode::selected));
  // The button is always there, so that the table below stays where it is when a click in it selects one mode.
  const bool all = range == modal::ModeRange{};
  if (all) ImGui::BeginDisabled();
  if (ImGui::SmallButton("All (T)")) commands.perform(Action::all_modes);
  if (all) ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::Text("%d of %zu modes, node %u of %s", played, modes.size(), commands.choice().node, object.name.c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("The test force of the R key strikes this node; . and / choose it");
  constexpr auto kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV;
  if (!ImGui::BeginTable("modes", 4, kFlags, ImGui::GetContentRegionAvail())) return;
  ImGui::TableSetupScrollFreeze(0, 1);
  for (const auto& [heading, weight, tip] : kColumns) {
    ImGui::TableSetupColumn(heading, ImGuiTableColumnFlags_WidthStretch, weight);
  }
  ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
  for (const auto& [heading, weight, tip] : kColumns) {
    ImGui::TableNextColumn();
    ImGui::TableHeader(heading);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  }
  const std::uint32_t chosen = commands.choice().mode;
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(modes.size()));
  while (clipper.Step()) {
    for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
      const auto rank = static_cast<std::uint32_t>(row);
      if (draw_row(skin, row, modes[rank], rank == chosen)) commands.hear_alone(object, rank);
    }
  }
  if (chosen != shown_mode_) keep_in_sight(chosen);
  shown_mode_ = chosen;
  ImGui::EndTable();
}

void SoundView::draw(const Skin& skin, Model& model, Commands& commands, bool alone) {
  const KnownObject* object = model.object(commands.choice().object);
  draw_meters(skin, model, commands.choice().tone);
  if (alone) draw_settings(object, commands);
  const float height = std::clamp(ImGui::GetContentRegionAvail().y * 0.2f, 70.0f, 260.0f);
  draw_curves(skin, model, height);
  draw_amplitudes(skin, model, commands, height);
  if (object && object->bank) draw_table(skin, *object, commands);
}

}  // namespace ringdown::viewer
