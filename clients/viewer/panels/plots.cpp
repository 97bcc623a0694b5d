#include "clients/viewer/panels/plots.h"

#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace ringdown::viewer {
namespace {

// The area of a plot, with its draw list and coordinates.
struct Area {
  ImDrawList* list;
  ImVec2 low, high;

  // Takes the next `size` of the window, of which a margin at the left and below is for labels.
  Area(const Skin& skin, const char* name, ImVec2 size) : list(ImGui::GetWindowDrawList()) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    size = {std::max(size.x, 40.0f), std::max(size.y, 40.0f)};
    ImGui::InvisibleButton(name, size);
    const float em = ImGui::GetFontSize();
    low = {at.x + 3.5f * em, at.y + 2};
    high = {at.x + size.x - 2, at.y + size.y - 1.3f * em};
    list->AddRectFilled(low, high, skin.paper);
    list->PushClipRect(low, high, true);
  }
  ~Area() { list->PopClipRect(); }
  Area(const Area&) = delete;
  Area& operator=(const Area&) = delete;

  [[nodiscard]] float width() const { return high.x - low.x; }
  [[nodiscard]] float x(double share) const { return low.x + static_cast<float>(share) * width(); }
  [[nodiscard]] float y(double share) const { return high.y - static_cast<float>(share) * (high.y - low.y); }
  [[nodiscard]] bool hovered() const { return ImGui::IsItemHovered() && ImGui::IsMouseHoveringRect(low, high); }
  [[nodiscard]] double mouse_x() const { return (ImGui::GetMousePos().x - low.x) / width(); }

  // Writes words from the upper right corner to the left, over the curves.
  void title(const Skin& skin, std::initializer_list<std::pair<const char*, ImU32>> words_from_the_right) const {
    const float em = ImGui::GetFontSize();
    float x = high.x;
    for (const auto& [word, colour] : words_from_the_right) {
      const float width = ImGui::CalcTextSize(word).x + 0.6f * em;
      x -= width;
      list->AddRectFilled({x, low.y}, {x + width, low.y + 1.2f * em},
                          (skin.paper & ~IM_COL32_A_MASK) | 200u << IM_COL32_A_SHIFT);
      list->AddText({x + 0.3f * em, low.y + 0.1f * em}, colour, word);
    }
  }

  // Labels come from left to right and from top to bottom. A label that would touch the one before is left out.
  void label_below(const Skin& skin, float at, const char* text) {
    const ImVec2 extent = ImGui::CalcTextSize(text);
    const float left = std::clamp(at - extent.x / 2, low.x, std::max(low.x, high.x - extent.x));
    if (left < right_of_labels_) return;
    right_of_labels_ = left + extent.x + 4;
    outside([&] { list->AddText({left, high.y + 2}, skin.faint, text); });
  }
  void label_left(const Skin& skin, float at, const char* text) {
    const ImVec2 extent = ImGui::CalcTextSize(text);
    const float top = std::clamp(at - extent.y / 2, low.y, std::max(low.y, high.y - extent.y));
    if (top < below_labels_) return;
    below_labels_ = top + extent.y;
    outside([&] { list->AddText({low.x - extent.x - 4, top}, skin.faint, text); });
  }

 private:
  float right_of_labels_ = -1e9f, below_labels_ = -1e9f;

  template <class Draw>
  void outside(Draw draw) const {
    list->PopClipRect();
    draw();
    list->PushClipRect(low, high, true);
  }
};

double share_of_frequency(double hz) {
  return std::log(hz / kMinFrequency_hz) / std::log(kMaxFrequency_hz / kMinFrequency_hz);
}
double frequency_of_share(double share) {
  return kMinFrequency_hz * std::pow(kMaxFrequency_hz / kMinFrequency_hz, share);
}
double share_of_level(double db) { return (db - kMinLevel_db) / (kMaxLevel_db - kMinLevel_db); }

void draw_grid(const Skin& skin, Area& area) {
  for (const auto& [hz, text] : {std::pair(100.0, "100"), {1000.0, "1 k"}, {10000.0, "10 kHz"}}) {
    const float x = area.x(share_of_frequency(hz));
    area.list->AddLine({x, area.low.y}, {x, area.high.y}, skin.grid);
    area.label_below(skin, x, text);
  }
  for (const auto& [db, text] : {std::pair(0.0, "0 dB"), {-40.0, "-40"}, {-80.0, "-80"}, {-120.0, "-120"}}) {
    const float y = area.y(share_of_level(db));
    area.list->AddLine({area.low.x, y}, {area.high.x, y}, skin.grid);
    area.label_left(skin, y, text);
  }
}

// The last frame from which `shown` frames remain and at which the curve rises through zero.
std::size_t trigger(std::span<const float> samples, std::size_t shown) {
  if (samples.size() <= shown) return 0;
  for (std::size_t i = samples.size() - shown; i > 0; --i) {
    if (samples[i - 1] < 0 && samples[i] >= 0) return i;
  }
  return samples.size() - shown;
}

void draw_wave(const Area& area, std::span<const float> samples, double peak, ImU32 colour) {
  std::vector<ImVec2> points;
  points.reserve(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(samples.size() - 1, 1));
    points.push_back({area.x(share), area.y(0.5 + 0.48 * samples[i] / peak)});
  }
  area.list->AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, 1.3f);
}

// A label and a horizontal bar, filled up to `share` with a line at `mark`, both 0 ... 1. The text comes next.
void draw_meter(const Skin& skin, const char* label, double share, double mark, ImU32 colour) {
  ImGui::TextUnformatted(label);
  ImGui::SameLine(5.5f * ImGui::GetFontSize());
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float text_width = 5 * ImGui::GetFontSize(), height = ImGui::GetFontSize();
  const float width = std::max(ImGui::GetContentRegionAvail().x - text_width, 20.0f);
  const auto x = [&](double value) { return at.x + width * static_cast<float>(std::clamp(value, 0.0, 1.0)); };
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, skin.paper);
  list->AddRectFilled(at, {x(share), at.y + height}, colour);
  list->AddLine({x(mark), at.y}, {x(mark), at.y + height}, skin.text, 2);
  ImGui::Dummy({width, height});
  ImGui::SameLine();
}

}  // namespace

double level_db(double amplitude) { return std::max(kMinLevel_db, 20 * std::log10(std::max(amplitude, 1e-9))); }

void draw_oscilloscope(const Skin& skin, ImVec2 size, std::span<const float> left, std::span<const float> right,
                       double sample_rate_hz) {
  Area area(skin, "waveform", size);
  constexpr double kShown_s = 0.02, kMinPeak = 1e-4;
  const auto shown = static_cast<std::size_t>(kShown_s * sample_rate_hz);
  const std::size_t first = trigger(left, shown);
  const auto part = [&](std::span<const float> s) {
    return s.size() <= first ? std::span<const float>() : s.subspan(first, std::min(shown, s.size() - first));
  };
  double peak = kMinPeak;
  for (const auto& side : {part(left), part(right)}) {
    for (const float sample : side) peak = std::max(peak, std::abs(static_cast<double>(sample)));
  }
  for (const double ms : {5.0, 10.0, 15.0}) {
    const float x = area.x(ms / 20);
    area.list->AddLine({x, area.low.y}, {x, area.high.y}, skin.grid);
    area.label_below(skin, x, formatted("{:.0f}{}", ms, ms == 15 ? " ms" : "").c_str());
  }
  area.list->AddLine({area.low.x, area.y(0.5)}, {area.high.x, area.y(0.5)}, skin.grid);
  area.label_left(skin, area.low.y, formatted("{:.2g}", peak).c_str());
  area.label_left(skin, area.y(0.5), "0");
  draw_wave(area, part(right), peak, series_colour(1));
  draw_wave(area, part(left), peak, series_colour(0));
  area.title(skin, {{"right", series_colour(1)}, {"left", series_colour(0)}, {"waveform", skin.faint}});
}

void draw_spectrum(const Skin& skin, ImVec2 size, std::span<const float> levels_db, double bin_hz) {
  Area area(skin, "spectrum", size);
  draw_grid(skin, area);
  const auto columns = static_cast<std::size_t>(std::max(area.width(), 1.0f));
  std::vector<ImVec2> points;
  const auto bin_at = [&](double share) {
    return std::clamp<std::size_t>(static_cast<std::size_t>(frequency_of_share(share) / bin_hz), 0,
                                   levels_db.empty() ? 0 : levels_db.size() - 1);
  };
  for (std::size_t column = 0; column < columns && !levels_db.empty(); ++column) {
    const std::size_t from = bin_at(static_cast<double>(column) / static_cast<double>(columns));
    const std::size_t to = std::max(from + 1, bin_at(static_cast<double>(column + 1) / static_cast<double>(columns)));
    const float level = *std::max_element(levels_db.begin() + static_cast<std::ptrdiff_t>(from),
                                          levels_db.begin() + static_cast<std::ptrdiff_t>(to));
    points.push_back({area.low.x + static_cast<float>(column), area.y(share_of_level(level))});
  }
  area.list->AddPolyline(points.data(), static_cast<int>(points.size()), skin.line, 0, 1.2f);
  area.title(skin, {{"spectrum", skin.faint}});
  if (area.hovered() && !levels_db.empty()) {
    const double share = area.mouse_x();
    ImGui::SetTooltip("%s",
                      formatted("{:.0f} Hz, {:.1f} dB", frequency_of_share(share), levels_db[bin_at(share)]).c_str());
  }
}

Picked draw_bars(const Skin& skin, ImVec2 size, std::span<const BarGroup> groups) {
  Area area(skin, "modes", size);
  draw_grid(skin, area);
  Picked nearest;
  float distance = 6;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t b = 0; b < groups[g].bars.size(); ++b) {
      const Bar& bar = groups[g].bars[b];
      const float x = area.x(share_of_frequency(bar.frequency_hz));
      const float top = area.y(share_of_level(level_db(bar.amplitude)));
      if (bar.chosen) area.list->AddLine({x, area.low.y}, {x, area.high.y}, skin.focus, 1);
      area.list->AddLine({x, area.high.y - 2}, {x, std::min(top, area.high.y - 2)}, groups[g].colour,
                         bar.chosen ? 3.0f : 2.0f);
      const float away = std::abs(ImGui::GetMousePos().x - x);
      if (away < distance) {
        distance = away;
        nearest = {static_cast<int>(g), static_cast<int>(b)};
      }
    }
  }
  area.title(skin, {{"ringing modes", skin.faint}});
  if (!area.hovered() || nearest.group < 0) return {};
  const BarGroup& group = groups[static_cast<std::size_t>(nearest.group)];
  const Bar& bar = group.bars[static_cast<std::size_t>(nearest.bar)];
  ImGui::SetTooltip("%s, mode %d: %s", group.name.c_str(), nearest.bar,
                    formatted("{:.1f} Hz, {:.0f} dB", bar.frequency_hz, level_db(bar.amplitude)).c_str());
  return ImGui::IsMouseClicked(ImGuiMouseButton_Left) ? nearest : Picked{};
}

void draw_level(const Skin& skin, const char* label, float peak, float held) {
  constexpr double kLow_db = -60;
  const double level = level_db(held);
  const auto share = [](double db) { return 1 - db / kLow_db; };
  draw_meter(skin, label, share(level_db(peak)), share(level),
             level > -0.5 ? skin.bad
             : level > -6 ? skin.warning
                          : skin.good);
  if (held > 0) {
    ImGui::Text("%5.1f dB", level);
  } else {
    ImGui::TextDisabled("silent");
  }
}

void draw_share(const Skin& skin, const char* label, double share, double mark, const std::string& text) {
  draw_meter(skin, label, share, mark, share > 0.9 ? skin.bad : share > 0.6 ? skin.warning : skin.good);
  ImGui::TextUnformatted(text.c_str());
}

}  // namespace ringdown::viewer
