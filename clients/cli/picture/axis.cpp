#include "clients/cli/picture/axis.h"

#include "engine/base/formatted.h"

#include <array>
#include <cmath>
#include <utility>

namespace ringdown::cli {

double Axis::share(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

Axis log_axis(double low, double high, std::string title) {
  Axis axis{low, high, true, std::move(title), {}};
  const bool many = high / low > 2000;
  for (double decade = std::pow(10, std::floor(std::log10(low))); decade <= high; decade *= 10) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double tick = decade * step;
      if (tick >= 0.999 * low && tick <= 1.001 * high && (!many || step == 1)) axis.ticks.push_back(tick);
    }
  }
  return axis;
}

Axis linear_axis(double low, double high, double step, std::string title) {
  Axis axis{low, high, false, std::move(title), {}};
  for (double tick = std::ceil(low / step) * step; tick <= high + 1e-9 * step; tick += step)
    axis.ticks.push_back(std::abs(tick) < 1e-9 * step ? 0 : tick);
  return axis;
}

std::string tick_label(double value) {
  return std::abs(value) >= 1000 ? formatted("{:g}k", value / 1000) : formatted("{:g}", value);
}

Dot Chart::at(double horizontal, double vertical) const {
  return {box.x + box.width * x.share(horizontal), box.y + box.height * (1 - y.share(vertical))};
}

void Chart::draw_frame(Canvas& canvas, double size) const {
  const double bottom = box.y + box.height, right = box.x + box.width;
  double taken = -1e9;  // up to where the last label goes
  for (const double tick : x.ticks) {
    const double place = at(tick, y.low).x, half = canvas.text_width(tick_label(tick), size) / 2;
    canvas.line(std::array<Dot, 2>{{{place, box.y}, {place, bottom}}}, kGrid, 1);
    if (place - half < taken) continue;
    canvas.text({place, bottom + 1.4 * size}, tick_label(tick), size, kFaint, Align::centre);
    taken = place + half + 0.6 * size;
  }
  for (const double tick : y.ticks) {
    const double place = at(x.low, tick).y;
    canvas.line(std::array<Dot, 2>{{{box.x, place}, {right, place}}}, kGrid, 1);
    canvas.text({box.x - 0.5 * size, place + 0.35 * size}, tick_label(tick), size, kFaint, Align::right);
  }
  canvas.line(std::array<Dot, 3>{{{box.x, box.y}, {box.x, bottom}, {right, bottom}}}, kFaint, 1);
  canvas.text({right, bottom + 2.8 * size}, x.title, size, kFaint, Align::right);
  canvas.text({box.x - 2.8 * size, box.y - 0.7 * size}, y.title, size, kFaint);
}

}  // namespace ringdown::cli
