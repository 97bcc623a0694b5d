// Curves, bars and meters, drawn with ImGui's draw list into the next `size` of the current window. Each has its axis
// with units and a tooltip with the value under the mouse. [UI]
#pragma once

#include "clients/viewer/panels/skin.h"

#include <span>
#include <string>
#include <vector>

namespace ringdown::viewer {

// Frequency axis of spectrum and bars: logarithmic.
inline constexpr double kLowest_hz = 20, kHighest_hz = 20000;
// Level axis [dB of full scale].
inline constexpr double kQuietest_db = -120, kLoudest_db = 0;

// The last `samples`, from the last upward zero crossing that leaves room, so that a steady tone stands still. Scaled
// to its own peak, at least `least_peak`.
void draw_oscilloscope(const Skin& skin, ImVec2 size, std::span<const float> left, std::span<const float> right,
                       double sample_rate_hz);

// Bin k of `levels_db` is at k * bin_hz.
void draw_spectrum(const Skin& skin, ImVec2 size, std::span<const float> levels_db, double bin_hz);

struct Bar {
  double frequency_hz;
  float amplitude;  // of full scale
  bool chosen;
};
struct BarGroup {  // an object's
  std::string name;
  ImU32 colour;
  std::vector<Bar> bars;
};
// Returns the bar under the mouse when it was clicked: its group and place there; -1 -1 for none.
struct Picked {
  int group = -1, bar = -1;
};
Picked draw_bars(const Skin& skin, ImVec2 size, std::span<const BarGroup> groups);

// A horizontal level meter in dB, with its held peak.
void draw_level(const Skin& skin, const char* label, float peak, float held);

// A share of something, 0 ... 1, with a text of its own.
void draw_share(const Skin& skin, const char* label, double share, double mark, const std::string& text);

// 20 log10, not below kQuietest_db.
double level_db(double amplitude);

}  // namespace ringdown::viewer
