// Colours and shapes of the window, dark and light. Curves take Okabe and Ito's palette ("Color Universal Design",
// 2008), which is distinguishable with any colour vision; no information is given by colour alone. [UI]
#pragma once

#include <imgui.h>

#include <cstddef>

namespace ringdown::viewer {

struct Skin {
  bool dark = true;
  ImU32 paper, grid, text, faint, line, good, warning, bad, focus;
};

Skin make_skin(bool dark);

// Returns the colour of the i-th object, voice or curve.
ImU32 series_colour(std::size_t i);

// Sets ImGui's style for a skin and a scale.
void apply(const Skin& skin, float scale);

// Draws the label of a row with its tooltip, `width_em` wide. The next item takes the rest of the row.
void label(const char* text, const char* tip, float width_em);

struct SliderRange {
  double min, max;
  bool logarithmic = true;
};

// Draws a row with a label and its tooltip, a slider, and the slider's number, which can be dragged for fine steps and
// clicked to type. Returns true while the user changes the value.
bool slider(const char* name, const char* tip, double& value, SliderRange range, const char* format);

}  // namespace ringdown::viewer
