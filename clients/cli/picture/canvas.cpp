#include "clients/cli/picture/canvas.h"

#include <cairo-svg.h>
#include <cairo.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace ringdown::cli {
namespace {

cairo_status_t append(void* text, const unsigned char* bytes, unsigned int count) {
  try {
    static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
  } catch (...) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

}  // namespace

Colour heat(double value) {
  constexpr std::array<Colour, 6> kStops = {{{0.267, 0.005, 0.329},
                                             {0.254, 0.265, 0.530},
                                             {0.164, 0.471, 0.558},
                                             {0.135, 0.659, 0.518},
                                             {0.478, 0.821, 0.318},
                                             {0.993, 0.906, 0.144}}};
  const double place = std::clamp(std::isfinite(value) ? value : 0.0, 0.0, 1.0) * (kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  const double share = place - static_cast<double>(below);
  const Colour &a = kStops[below], &b = kStops[below + 1];
  return {a.red + share * (b.red - a.red), a.green + share * (b.green - a.green), a.blue + share * (b.blue - a.blue)};
}

struct Canvas::State {
  Kind kind;
  std::string bytes;
  cairo_surface_t* surface = nullptr;
  cairo_t* pen = nullptr;

  void colour(Colour c) const { cairo_set_source_rgba(pen, c.red, c.green, c.blue, c.alpha); }
  void path(std::span<const Dot> points) const {
    cairo_new_path(pen);
    for (const Dot& p : points) cairo_line_to(pen, p.x, p.y);
  }
  void font(double size, bool bold) const {
    cairo_select_font_face(pen, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(pen, size);
  }
};

Canvas::Canvas(Kind kind, double width, double height) : state_(std::make_unique<State>(State{kind})) {
  State& s = *state_;
  s.surface = kind == Kind::svg
                  ? cairo_svg_surface_create_for_stream(append, &s.bytes, width, height)
                  : cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height));
  s.pen = cairo_create(s.surface);
  cairo_set_line_join(s.pen, CAIRO_LINE_JOIN_ROUND);
  s.colour(kPaper);
  cairo_paint(s.pen);
}

Canvas::~Canvas() {
  cairo_destroy(state_->pen);
  cairo_surface_destroy(state_->surface);
}

void Canvas::line(std::span<const Dot> points, Colour colour, double width) {
  state_->path(points);
  state_->colour(colour);
  cairo_set_line_width(state_->pen, width);
  cairo_stroke(state_->pen);
}

void Canvas::area(std::span<const Dot> corners, Colour fill) {
  state_->path(corners);
  cairo_close_path(state_->pen);
  state_->colour(fill);
  cairo_fill(state_->pen);
}

void Canvas::disc(Dot centre, double radius, Colour fill) {
  cairo_new_path(state_->pen);
  cairo_arc(state_->pen, centre.x, centre.y, radius, 0, 2 * M_PI);
  state_->colour(fill);
  cairo_fill(state_->pen);
}

double Canvas::text_width(const std::string& utf8, double size, bool bold) {
  cairo_text_extents_t extents;
  state_->font(size, bold);
  cairo_text_extents(state_->pen, utf8.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(Dot baseline, const std::string& utf8, double size, Colour colour, Align align, bool bold) {
  const double width = text_width(utf8, size, bold);
  const double back = align == Align::left ? 0 : align == Align::right ? width : width / 2;
  state_->colour(colour);
  cairo_move_to(state_->pen, baseline.x - back, baseline.y);
  cairo_show_text(state_->pen, utf8.c_str());
}

void Canvas::clip(Dot corner, double width, double height) {
  cairo_save(state_->pen);
  cairo_rectangle(state_->pen, corner.x, corner.y, width, height);
  cairo_clip(state_->pen);
}

void Canvas::unclip() { cairo_restore(state_->pen); }

std::string Canvas::finish() && {
  State& s = *state_;
  const bool good = cairo_status(s.pen) == CAIRO_STATUS_SUCCESS;
  if (s.kind == Kind::png) cairo_surface_write_to_png_stream(s.surface, append, &s.bytes);
  cairo_surface_finish(s.surface);
  return good && cairo_surface_status(s.surface) == CAIRO_STATUS_SUCCESS ? std::move(s.bytes) : std::string();
}

}  // namespace ringdown::cli
