#include "clients/cli/picture/bank_picture.h"

#include "clients/cli/picture/bank_page.h"
#include "clients/cli/picture/shape_view.h"
#include "engine/base/note.h"
#include "engine/modal/damping.h"
#include "engine/modal/fracture/strength.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace ringdown::cli {
namespace {

// The text, cut between two letters to fit into `width`, with an ellipsis where it was cut.
std::string fitting(Canvas& canvas, std::string text, double size, double width, bool bold = false) {
  if (canvas.text_width(text, size, bold) <= width) return text;
  while (!text.empty() && canvas.text_width(text + "…", size, bold) > width) {
    while (!text.empty() && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    if (!text.empty()) text.pop_back();
  }
  return text + "…";
}

std::string frequency_text(double hz) {
  return hz >= 10000  ? formatted("{:.2f} kHz", hz / 1000)
         : hz >= 1000 ? formatted("{:.3f} kHz", hz / 1000)
                      : formatted("{:.1f} Hz", hz);
}

std::string t60_text(double decay) { return decay > 0 ? formatted("T60 {:.3g} s", modal::t60_s(decay)) : "no decay"; }

std::string subtitle(const modal::Bank& bank) {
  const auto [low, high] = std::ranges::minmax(bank.frequency_hz);
  std::string text = bank.material && !bank.material->name.empty() ? clean_text(bank.material->name) + "  ·  " : "";
  text += formatted("{} modes, {} to {}", bank.mode_count(), frequency_text(low), frequency_text(high));
  if (bank.mass) text += formatted("  ·  {:.3g} kg", bank.mass->mass_kg);
  return text;
}

struct Level {
  double hz, db;
};

// Samples at every half pixel and at each mode, so that no peak is missed.
std::vector<Level> spectrum_of(const modal::Bank& bank, const Answer& answer, const Axis& axis, double pixels) {
  std::vector<double> places = bank.frequency_hz;
  const int count = static_cast<int>(2 * pixels);
  for (int n = 0; n <= count; ++n)
    places.push_back(axis.low * std::pow(axis.high / axis.low, static_cast<double>(n) / count));
  std::erase_if(places, [&](double hz) { return hz < axis.low || hz > axis.high; });
  std::ranges::sort(places);
  std::vector<Level> levels;
  for (const double hz : places) levels.push_back({hz, level_db(bank, answer, hz)});
  return levels;
}

Axis frequency_axis(const modal::Bank& bank, const std::string& title) {
  const auto [low, high] = std::ranges::minmax(bank.frequency_hz);
  double bottom = 1000;
  for (const double step : {500.0, 200.0, 100.0, 50.0, 20.0}) bottom = bottom > low / 1.4 ? step : bottom;
  return log_axis(std::min(bottom, low / 1.4), std::max(20000.0, high * 1.2), title);
}

// The loudest peaks by name, where there is room for it.
void label_peaks(Canvas& canvas, const Chart& chart, const modal::Bank& bank, const std::vector<Level>& levels,
                 const Answer& answer, double top, double size) {
  std::vector<std::size_t> order(levels.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t n) { return levels[n].db; });
  std::vector<double> taken;
  const double room = 1.15 * canvas.text_width("00.00 kHz", size);
  for (const std::size_t n : order) {
    if (taken.size() >= 7 || levels[n].db < top - 45) return;
    const Dot place = chart.at(levels[n].hz, levels[n].db - top);
    const double x = std::clamp(place.x, chart.box.x + room / 2, chart.box.x + chart.box.width - room / 2);
    if (std::ranges::any_of(taken, [&](double t) { return std::abs(t - x) < room; })) continue;
    const auto stands_out = [&](double from) { return level_db(bank, answer, levels[n].hz * from) < levels[n].db - 3; };
    const bool is_peak = stands_out(0.985) && stands_out(1.015);
    if (!is_peak) continue;
    canvas.text({x, place.y - 0.5 * size}, frequency_text(levels[n].hz), size, kInk, Align::centre);
    taken.push_back(x);
  }
}

void draw_spectrum(Canvas& canvas, const Box& box, const modal::Bank& bank, const Answer& answer, double size,
                   bool labels) {
  constexpr double kRange_db = 80, kHeadroom_db = 10;
  const Chart chart{box, frequency_axis(bank, labels ? "frequency [Hz]" : ""),
                    linear_axis(-kRange_db, kHeadroom_db, 20, labels ? "level [dB]" : "")};
  const std::vector<Level> levels = spectrum_of(bank, answer, chart.x, box.width);
  double top = -1e300;
  for (const Level& level : levels) top = std::max(top, level.db);
  chart.draw_frame(canvas, size);
  std::vector<Dot> curve = {{box.x, box.y + box.height}};
  for (const Level& level : levels) curve.push_back(chart.at(level.hz, std::max(level.db - top, -kRange_db)));
  curve.push_back({box.x + box.width, box.y + box.height});
  canvas.clip({box.x, box.y}, box.width, box.height);
  canvas.area(curve, {kBlue.red, kBlue.green, kBlue.blue, 0.15});
  canvas.line(std::span(curve).subspan(1, curve.size() - 2), kBlue, labels ? 1.2 : 0.9);
  canvas.unclip();
  if (labels) label_peaks(canvas, chart, bank, levels, answer, top, size);
}

void draw_decays(Canvas& canvas, const Box& box, const modal::Bank& bank, const Answer& answer, double size) {
  double low = INFINITY, high = 0, loudest = 1e-300;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    loudest = std::max(loudest, std::abs(answer.amplitude[m]));
    if (bank.decay_per_s[m] <= 0) continue;
    low = std::min(low, modal::t60_s(bank.decay_per_s[m]));
    high = std::max(high, modal::t60_s(bank.decay_per_s[m]));
  }
  if (high <= 0) low = high = 1;
  const Chart chart{box, frequency_axis(bank, "frequency [Hz]"), log_axis(low / 1.6, high * 1.6, "T60 [s]")};
  chart.draw_frame(canvas, size);
  for (std::size_t m = bank.mode_count(); m-- > 0;) {
    if (bank.decay_per_s[m] <= 0) continue;
    const double quiet = 1 + 20 * std::log10(std::abs(answer.amplitude[m]) / loudest + 1e-9) / 60;
    canvas.disc(chart.at(bank.frequency_hz[m], modal::t60_s(bank.decay_per_s[m])), 2 + 3 * std::clamp(quiet, 0.0, 1.0),
                {kOrange.red, kOrange.green, kOrange.blue, 0.75});
  }
}

void draw_legend(Canvas& canvas, Dot corner, double width, double size) {
  constexpr int kSteps = 48;
  for (int n = 0; n < kSteps; ++n) {
    const double left = corner.x + width * n / kSteps, right = corner.x + width;
    const std::array<Dot, 4> step = {
        {{left, corner.y}, {right, corner.y}, {right, corner.y + 8}, {left, corner.y + 8}}};
    canvas.area(step, heat((n + 0.5) / kSteps));
  }
  canvas.text({corner.x - 8, corner.y + 8}, "rests", size, kFaint, Align::right);
  canvas.text({corner.x + width + 8, corner.y + 8}, "moves most", size, kFaint);
}

std::string struck_text(const modal::Bank& bank, const Answer& answer) {
  const auto& p = bank.positions[answer.point];
  const auto to_microns = [](double metres) { return std::round(metres * 1e6) / 1e6 + 0.0; };
  return formatted("Struck at ({:.4g}, {:.4g}, {:.4g}) m", to_microns(p[0]), to_microns(p[1]), to_microns(p[2]));
}

constexpr std::size_t kShown = 4;
constexpr double kMargin = 40;

// The first of the bank, but of those that have one pitch, as the pairs of round bodies do, only one.
std::vector<std::size_t> modes_to_show(const modal::Bank& bank) {
  std::vector<std::size_t> modes;
  for (std::size_t m = 0; m < bank.mode_count() && modes.size() < kShown; ++m) {
    const auto alike = [&](std::size_t k) { return std::abs(bank.frequency_hz[k] / bank.frequency_hz[m] - 1) < 0.003; };
    if (std::ranges::none_of(modes, alike)) modes.push_back(m);
  }
  return modes;
}

std::string pieces_text(const modal::Fracture& fracture, const modal::BreakPattern& pattern) {
  const auto silent =
      std::ranges::count_if(pattern.pieces, [](const auto& piece) { return piece.bank.mode_count() == 0; });
  std::string text = formatted("{} pieces", pattern.pieces.size());
  if (silent > 0) text += formatted(", {} only click", static_cast<std::size_t>(silent));
  text += formatted("  ·  {:.3g} cm² of cracks", 1e4 * pattern.crack_area_m2);
  if (const double cost_j = modal::crack_cost_j(pattern.crack_area_m2, fracture.crack_energy_j_m2); cost_j > 0)
    text += formatted(" take {:.2g} J", cost_j);
  return text;
}

// The first patterns, together and apart.
void draw_fracture(Canvas& canvas, const modal::Fracture& fracture, double top, double margin) {
  constexpr double kApart = 0.5, kHeight = 224;
  const std::size_t shown = std::min<std::size_t>(fracture.patterns.size(), 2);
  const double side = (kPictureWidth - 2 * margin) / 4;
  std::string title = "The pieces where the marked place is struck; grey ones only click";
  if (fracture.patterns.size() > shown) title += formatted(" ({} of {} patterns)", shown, fracture.patterns.size());
  canvas.text({margin, top}, title, 14, kInk, Align::left, true);
  for (std::size_t p = 0; p < shown; ++p) {
    const double left = margin + 2 * side * static_cast<double>(p);
    draw_pieces(canvas, {left, top + 14, side, kHeight}, fracture.patterns[p], 0);
    draw_pieces(canvas, {left + side, top + 14, side, kHeight}, fracture.patterns[p], kApart);
    canvas.text({left + side, top + kHeight + 34}, pieces_text(fracture, fracture.patterns[p]), 12, kFaint,
                Align::centre);
  }
}

void draw_small(Canvas& canvas, const modal::Bank& bank, const Answer& answer) {
  draw_shape(canvas, {4, 4, 222, 192}, bank, 0);
  draw_spectrum(canvas, {262, 12, 206, 160}, bank, answer, 9, false);
}

void draw_spectrum_and_decays(Canvas& canvas, const modal::Bank& bank, const Answer& answer, double top) {
  constexpr double kSize = 12;
  const double left = kMargin + 36, width = kPictureWidth - 2 * kMargin - 36;
  canvas.text({kMargin, top}, struck_text(bank, answer) + (bank.triangles.empty() ? "" : ", along the normal"), 14,
              kInk, Align::left, true);
  draw_spectrum(canvas, {left, top + 30, width, 190}, bank, answer, kSize, true);
  canvas.text({kMargin, top + 286}, "T60 of each mode; larger dots are louder at this point", 14, kInk, Align::left,
              true);
  draw_decays(canvas, {left, top + 316, width, 130}, bank, answer, kSize);
}

void draw_large(Canvas& canvas, const modal::Bank& bank, const Answer& answer) {
  const double width = kPictureWidth - 2 * kMargin;
  canvas.text({kMargin, 44}, fitting(canvas, clean_text(bank.name.empty() ? "bank" : bank.name), 24, width, true), 24,
              kInk, Align::left, true);
  canvas.text({kMargin, 68}, fitting(canvas, subtitle(bank), 14, width), 14, kFaint);
  const double side = width / kShown;
  double left = kMargin - side;
  for (const std::size_t m : modes_to_show(bank)) {
    left += side;
    draw_shape(canvas, {left, 84, side, 214}, bank, m, &answer.point);
    canvas.text({left + side / 2, 318}, formatted("mode {}  ·  {}", m, frequency_text(bank.frequency_hz[m])), 13, kInk,
                Align::centre, true);
    canvas.text({left + side / 2, 336}, note_name(bank.frequency_hz[m]) + "  ·  " + t60_text(bank.decay_per_s[m]), 12,
                kFaint, Align::centre);
  }
  draw_legend(canvas, {kPictureWidth / 2 - 60, 352}, 120, 11);
  draw_spectrum_and_decays(canvas, bank, answer, 398);
  if (bank.fracture) draw_fracture(canvas, *bank.fracture, kPictureHeight + 12, kMargin);
}

}  // namespace

std::string draw_bank(Canvas::Kind kind, const modal::Bank& bank, const Answer& answer, bool small) {
  const double height = kPictureHeight + (bank.fracture ? kPiecesHeight : 0);
  Canvas canvas(kind, small ? kSmallWidth : kPictureWidth, small ? kSmallHeight : height);
  small ? draw_small(canvas, bank, answer) : draw_large(canvas, bank, answer);
  return std::move(canvas).finish();
}

std::string draw_answer(const modal::Bank& bank, const Answer& answer) {
  constexpr double kTop = 20, kHeight = 522;
  Canvas canvas(Canvas::Kind::svg, kPictureWidth, kHeight);
  draw_spectrum_and_decays(canvas, bank, answer, kTop);
  return std::move(canvas).finish();
}

}  // namespace ringdown::cli
