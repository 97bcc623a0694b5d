// Curves, bars and meters, drawn with ImGui's draw list into the next `size` of the current window. Each has axes with
// units, and a tooltip with the value under the mouse. [UI]
#pragma once

#include "clients/viewer/panels/skin.h"

#include <span>
#include <string>
#include <vector>

namespace ringdown::viewer {

// The logarithmic frequency axis of spectrum and bars.
inline constexpr double kMinFrequency_hz = 20, kMaxFrequency_hz = 20000;
// The level axis [dB of full scale].
inline constexpr double kMinLevel_db = -120, kMaxLevel_db = 0;

// Draws 20 ms of both channels from the last upward zero crossing of the left channel that leaves room, so that a
// steady tone appears stationary. The curves are scaled to their peak.
void draw_oscilloscope(const Skin& skin, ImVec2 size, std::span<const float> left, std::span<const float> right,
                       double sample_rate_hz);

// Draws a spectrum; bin k of `levels_db` lies at k * bin_hz.
void draw_spectrum(const Skin& skin, ImVec2 size, std::span<const float> levels_db, double bin_hz);

struct Bar {
  double frequency_hz;
  float amplitude;  // relative to full scale
  bool chosen;
};
struct BarGroup {  // the bars of one object
  std::string name;
  ImU32 colour;
  std::vector<Bar> bars;
};
// A bar: the index of its group, and its index in the group; -1 for none.
struct Picked {
  int group = -1, bar = -1;
};
// Draws the bars of all groups, and returns the bar under the mouse if it was clicked.
Picked draw_bars(const Skin& skin, ImVec2 size, std::span<const BarGroup> groups);

// Draws a horizontal level meter in dB, with its held peak.
void draw_level(const Skin& skin, const char* label, float peak, float held);

// Draws a meter for a share of 0 ... 1 with a mark, and a text.
void draw_share(const Skin& skin, const char* label, double share, double mark, const std::string& text);

// Returns 20 log10 of the amplitude, at least kMinLevel_db.
double level_db(double amplitude);

}  // namespace ringdown::viewer
