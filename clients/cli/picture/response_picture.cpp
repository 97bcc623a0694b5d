#include "clients/cli/picture/response_picture.h"

#include "clients/cli/picture/axis.h"
#include "clients/cli/picture/bank_page.h"
#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

constexpr double kResponseWidth = 1120, kResponseHeight = 560, kTextSize = 12;

// A step of 1, 2 or 5 times a power of ten that divides the length into about `count`.
double step_for(double length, double count) {
  const double power = std::pow(10, std::floor(std::log10(length / count)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power * count >= length) return step * power;
  }
  return 10 * power;
}

double level_db(const ResponseTable& table, std::size_t i) {
  const double decibels = table.kind == ResponseTable::Kind::energy ? 10 : 20;
  return decibels * std::log10(std::abs(table.values[i]) + 1e-300);
}

void draw_curve(Canvas& canvas, const Chart& chart, const std::vector<Dot>& curve, Colour colour) {
  const auto& [x, y, width, height] = chart.box;
  canvas.clip({x, y}, width, height);
  canvas.line(curve, colour, 1.4);
  canvas.unclip();
}

void draw_magnitude(Canvas& canvas, const ResponseTable& table, const Axis& frequencies) {
  double top = -1e300, bottom = 1e300;
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    top = std::max(top, level_db(table, i));
    bottom = std::min(bottom, level_db(table, i));
  }
  bottom = std::max(bottom, top - 140);
  const double high = std::ceil((top + 3) / 10) * 10, low = std::min(std::floor(bottom / 10) * 10, high - 20);
  const bool alone = table.kind == ResponseTable::Kind::energy;
  Axis x = frequencies;
  if (!alone) x.title = "";
  const Chart chart{
      alone ? Box{86, 90, 994, 400} : Box{86, 90, 610, 220}, x,
      linear_axis(low, high, high - low > 80 ? 20 : 10, formatted("magnitude [dB re 1 {}]", unit_of(table.kind)))};
  chart.draw_frame(canvas, kTextSize);
  std::vector<Dot> curve;
  for (std::size_t i = 0; i < table.values.size(); ++i)
    curve.push_back(chart.at(table.frequencies_hz[i], level_db(table, i)));
  draw_curve(canvas, chart, curve, kBlue);
}

// Each jump from -180 to 180 degrees begins a new line.
void draw_phase(Canvas& canvas, const ResponseTable& table, const Axis& frequencies) {
  const Chart chart{{86, 360, 610, 130}, frequencies, linear_axis(-180, 180, 90, "phase [degrees]")};
  chart.draw_frame(canvas, kTextSize);
  std::vector<Dot> curve;
  double before = 0;
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    const double degrees = std::arg(table.values[i]) * 180 / std::numbers::pi;
    if (i > 0 && std::abs(degrees - before) > 180) {
      draw_curve(canvas, chart, curve, kOrange);
      curve.clear();
    }
    curve.push_back(chart.at(table.frequencies_hz[i], degrees));
    before = degrees;
  }
  draw_curve(canvas, chart, curve, kOrange);
}

void draw_nyquist(Canvas& canvas, const ResponseTable& table) {
  double left = 0, right = 0, low = 0, high = 0;
  for (const auto& value : table.values) {
    left = std::min(left, value.real()), right = std::max(right, value.real());
    low = std::min(low, value.imag()), high = std::max(high, value.imag());
  }
  const double side = 1.1 * std::max({right - left, high - low, 1e-290});
  const int power = static_cast<int>(std::floor(std::log10(side / 2) / 3)) * 3;
  const double unit = std::pow(10.0, power), half = side / unit / 2, step = step_for(2 * half, 5);
  const double x = (left + right) / unit / 2, y = (low + high) / unit / 2;
  const std::string scale = power == 0 ? unit_of(table.kind) : formatted("10^{} {}", power, unit_of(table.kind));
  const Chart chart{{790, 90, 290, 290},
                    linear_axis(x - half, x + half, step, "real [" + scale + "]"),
                    linear_axis(y - half, y + half, step, "imaginary [" + scale + "]")};
  chart.draw_frame(canvas, kTextSize);
  std::vector<Dot> curve;
  for (const auto& value : table.values) curve.push_back(chart.at(value.real() / unit, value.imag() / unit));
  draw_curve(canvas, chart, curve, kBlue);
  if (x - half <= 0 && x + half >= 0 && y - half <= 0 && y + half >= 0) canvas.disc(chart.at(0, 0), 2.5, kInk);
}

std::string place_text(Vec3 place, Vec3 direction, bool is_air) {
  const std::string text = formatted("({:.4g}, {:.4g}, {:.4g}) m", place.x, place.y, place.z);
  return is_air ? text : formatted("{} along ({:.3g}, {:.3g}, {:.3g})", text, direction.x, direction.y, direction.z);
}

}  // namespace

std::string draw_response(Canvas::Kind kind, const ResponseTable& table) {
  Canvas canvas(kind, kResponseWidth, kResponseHeight);
  const bool is_air = table.kind == ResponseTable::Kind::pressure;
  canvas.text({40, 36}, clean_text(table.name.empty() ? "bank" : table.name) + "  ·  " + name_of(table.kind), 20, kInk,
              Align::left, true);
  const bool of_energy = table.kind == ResponseTable::Kind::energy;
  const std::string struck = place_text(table.at_m, table.direction, false);
  canvas.text({40, 58},
              of_energy ? "after an impulse of 1 N s at " + struck
                        : "force at " + struck + ", response at " + place_text(table.to_m, table.to_direction, is_air),
              13, kFaint);
  const Axis frequencies = log_axis(table.frequencies_hz.front(), table.frequencies_hz.back(), "frequency [Hz]");
  draw_magnitude(canvas, table, frequencies);
  if (!of_energy) {
    draw_phase(canvas, table, frequencies);
    draw_nyquist(canvas, table);
  }
  return std::move(canvas).finish();
}

}  // namespace ringdown::cli
