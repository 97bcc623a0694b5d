// The controls of all parameters by their groups, and the meter of the level. [UI]
#pragma once

#include "clients/plugin/window/edits.h"

#include <algorithm>
#include <array>

namespace ringdown::plugin {

// Draws the controls into ImGui's present window. Each shows its value as parameter_text.h writes it. A right click
// opens a field to type into.
class Sliders {
 public:
  void draw(Edits& edits);

 private:
  void draw_one(Parameter parameter, Edits& edits);
  void draw_field(Parameter parameter, Edits& edits);
  std::array<char, 64> typed_{};
};

// The level of the output with its held peak.
class LevelMeter {
 public:
  static constexpr double kLow_db = -66, kHigh_db = 6;

  // Tells the level at a time.
  void follow(double level_db, double now_s);
  // Returns whether the picture changes without another level: a held peak is to fall.
  [[nodiscard]] bool is_moving() const { return held_db_ > std::max(level_db_, kLow_db); }
  [[nodiscard]] double held_db() const { return held_db_; }
  void draw(float width, float height) const;

 private:
  double level_db_ = -120, held_db_ = -120, held_at_s_ = 0;
};

}  // namespace ringdown::plugin
