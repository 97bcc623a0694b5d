// The frame of a chart: two axes with ticks, and the map from values to the sheet. [any]
#pragma once

#include "clients/cli/picture/canvas.h"

#include <string>
#include <vector>

namespace ringdown::cli {

struct Box {
  double x, y, width, height;
};

struct Axis {
  double low, high;
  bool logarithmic = false;
  std::string title;
  std::vector<double> ticks;

  [[nodiscard]] double share(double value) const;  // 0 at low, 1 at high
};

// Returns an axis with ticks at 1, 2 and 5 of each decade, or only at decades if there are more than three.
Axis log_axis(double low, double high, std::string title);
Axis linear_axis(double low, double high, double step, std::string title);

// Returns a number as ticks show it: "200", "2k", "0.05".
std::string tick_label(double value);

struct Chart {
  Box box;  // area of the plot; labels lie outside
  Axis x, y;

  [[nodiscard]] Dot at(double horizontal, double vertical) const;
  void draw_frame(Canvas& canvas, double text_size) const;
};

}  // namespace ringdown::cli
