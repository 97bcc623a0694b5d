// A sheet to draw on, written as a PNG or an SVG: equal calls give equal pictures.
//
//   Canvas canvas(Canvas::Kind::svg, 800, 600);
//   canvas.line(std::array<Dot, 2>{{{10, 10}, {90, 90}}}, kInk, 2);
//   const std::string bytes = std::move(canvas).finish();
//
// Points are in pixels from the top left corner. Letters are from the system's sans-serif. [one thread]
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>

namespace ringdown::cli {

struct Colour {
  double red, green, blue, alpha = 1;
};
inline constexpr Colour kPaper{1, 1, 1}, kInk{0.13, 0.15, 0.19}, kFaint{0.45, 0.48, 0.53}, kGrid{0.89, 0.90, 0.92},
    kBlue{0, 0.447, 0.698}, kOrange{0.835, 0.369, 0};  // the last two: Okabe & Ito, distinguishable by the colour-blind

// Maps 0 ... 1 to dark violet, blue, green, yellow: even in lightness, and distinguishable by the colour-blind
// (viridis).
Colour heat(double value);

struct Dot {
  double x, y;
};

enum class Align { left, centre, right };

class Canvas {
 public:
  enum class Kind { png, svg };
  Canvas(Kind kind, double width, double height);  // filled with kPaper
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void line(std::span<const Dot> points, Colour colour, double width);
  void area(std::span<const Dot> corners, Colour fill);  // fills the closed polygon
  void disc(Dot centre, double radius, Colour fill);
  void text(Dot baseline, const std::string& utf8, double size, Colour colour, Align align = Align::left,
            bool bold = false);
  [[nodiscard]] double text_width(const std::string& utf8, double size, bool bold = false);
  void clip(Dot corner, double width, double height);  // in effect until unclip()
  void unclip();

  // Returns the file's bytes; nothing can be drawn afterwards. Empty if the drawing failed for lack of memory.
  [[nodiscard]] std::string finish() &&;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ringdown::cli
