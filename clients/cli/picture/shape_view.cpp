#include "clients/cli/picture/shape_view.h"

#include "clients/cli/picture/answer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

namespace ringdown::cli {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr double kBend = 0.08;  // largest displacement, of the body's size

struct View {
  std::vector<Vec3> points;  // x, y on the sheet; z towards the eye, in the body's units
  std::vector<double> move;  // 0 ... 1
};

// Moves points to the middle of the box and makes them as large as fits. `low` and `high` bound what is to be seen.
void fit(std::span<Vec3> points, const Box& box, Dot low, Dot high) {
  const double width = std::max(high.x - low.x, 1e-9), height = std::max(high.y - low.y, 1e-9);
  const double scale = 0.9 * std::min(box.width / width, box.height / height);
  for (Vec3& p : points) {
    p.x = box.x + box.width / 2 + scale * (p.x - (low.x + high.x) / 2);
    p.y = box.y + box.height / 2 - scale * (p.y - (low.y + high.y) / 2);
    p.z *= scale;
  }
}

View view_of(const modal::Bank& bank, std::size_t mode, const Box& box) {
  double max = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  Vec3 from{INFINITY, INFINITY, INFINITY}, to{-INFINITY, -INFINITY, -INFINITY};
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    max = std::max(max, length(wide(bank.shape(mode, p))));
    const Vec3 x = wide(bank.positions[p]);
    from = {std::min(from.x, x.x), std::min(from.y, x.y), std::min(from.z, x.z)};
    to = {std::max(to.x, x.x), std::max(to.y, x.y), std::max(to.z, x.z)};
  }
  const double bend = max > 0 ? kBend * length(to - from) / max : 0;
  View view;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    const Vec3 phi = wide(bank.shape(mode, p));
    view.points.push_back(seen_from_front(wide(bank.positions[p]) + bend * phi));
    view.move.push_back(max > 0 ? length(phi) / max : 0);
    low[0] = std::min(low[0], view.points[p].x);
    high[0] = std::max(high[0], view.points[p].x);
    low[1] = std::min(low[1], view.points[p].y);
    high[1] = std::max(high[1], view.points[p].y);
  }
  fit(view.points, box, {low[0], low[1]}, {high[0], high[1]});
  return view;
}

void draw_points(Canvas& canvas, const View& view) {
  for (std::size_t p = 0; p < view.points.size(); ++p) {
    canvas.disc({view.points[p].x, view.points[p].y}, 4, heat(view.move[p]));
  }
}

// Grown by a little, or the paper would shine through between neighbours.
std::array<Dot, 3> corners_of(std::span<const Vec3> points, const Triangle& triangle) {
  constexpr double kGrow = 0.6;  // pixels
  std::array<Dot, 3> corners;
  Dot middle{0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = {points[triangle[k]].x, points[triangle[k]].y};
    middle = {middle.x + corners[k].x / 3, middle.y + corners[k].y / 3};
  }
  for (Dot& corner : corners) {
    const double x = corner.x - middle.x, y = corner.y - middle.y, size = std::max(std::hypot(x, y), 1e-9);
    corner = {corner.x + kGrow * x / size, corner.y + kGrow * y / size};
  }
  return corners;
}

// The farthest first. A face that looks away is seen from inside, where the body is open or thin: a little darker.
template <class ColourOf>
void draw_faces(Canvas& canvas, std::span<const Vec3> points, std::span<const Triangle> triangles,
                const ColourOf& colour_of) {
  std::vector<std::size_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto depth = [&](std::size_t t) {
    const auto& [a, b, c] = triangles[t];
    return points[a].z + points[b].z + points[c].z;
  };
  std::ranges::stable_sort(order, {}, depth);
  for (const std::size_t t : order) {
    const auto& [a, b, c] = triangles[t];
    const Vec3 normal = cross(points[b] - points[a], points[c] - points[a]);
    const double size = length(normal);
    const double facing = size > 0 ? std::abs(normal.z) / size : 1;
    const double light = 0.62 + 0.38 * facing;
    const Colour colour = colour_of(t);
    canvas.area(corners_of(points, triangles[t]), {light * colour.red, light * colour.green, light * colour.blue});
  }
}

// Neighbours in number differ much in hue: by the golden ratio of the circle.
Colour piece_colour(std::size_t piece) {
  const double hue = 2 * std::numbers::pi * std::fmod(0.6180339887 * static_cast<double>(piece) + 0.55, 1.0);
  const auto part = [&](double shift) { return 0.66 + 0.27 * std::cos(hue - shift * 2 * std::numbers::pi / 3); };
  return {part(0), part(1), part(2)};
}

void mark(Canvas& canvas, const Vec3& place) {
  canvas.disc({place.x, place.y}, 5, kPaper);
  canvas.disc({place.x, place.y}, 3.5, kOrange);
}

}  // namespace

Vec3 seen_from_front(Vec3 p) {
  constexpr double kTurn = -0.55, kTilt = 0.50;  // [rad]
  const double c = std::cos(kTurn), s = std::sin(kTurn), ct = std::cos(kTilt), st = std::sin(kTilt);
  const double right = c * p.x - s * p.y, away = s * p.x + c * p.y;
  return {right, ct * p.z + st * away, st * p.z - ct * away};
}

void draw_shape(Canvas& canvas, const Box& box, const modal::Bank& bank, std::size_t mode, const std::size_t* struck) {
  if (std::max(bank.triangles.size(), bank.point_count()) > kMaxDrawn) {
    canvas.text({box.x + box.width / 2, box.y + box.height / 2}, "too many triangles to draw", 12, kFaint,
                Align::centre);
    return;
  }
  if (bank.point_count() == 1) {
    canvas.text({box.x + box.width / 2, box.y + box.height / 2}, "one point, no surface", 12, kFaint, Align::centre);
    return;
  }
  const View view = view_of(bank, mode, box);
  if (bank.triangles.empty()) {
    draw_points(canvas, view);
  } else {
    draw_faces(canvas, view.points, bank.triangles, [&](std::size_t t) {
      const auto& [a, b, c] = bank.triangles[t];
      return heat((view.move[a] + view.move[b] + view.move[c]) / 3);
    });
  }
  if (struck) mark(canvas, view.points[*struck]);
}

void draw_pieces(Canvas& canvas, const Box& box, const modal::BreakPattern& pattern, double apart) {
  constexpr Colour kSilent{0.72, 0.73, 0.75};
  Vec3 centre;
  double mass_kg = 0;
  for (const modal::PieceBank& piece : pattern.pieces) {
    if (!piece.bank.mass) continue;
    centre = centre + piece.bank.mass->mass_kg * piece.bank.mass->center_of_mass_m;
    mass_kg += piece.bank.mass->mass_kg;
  }
  if (mass_kg > 0) centre = (1 / mass_kg) * centre;
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  std::vector<std::size_t> owners;
  for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
    const modal::Bank& bank = pattern.pieces[i].bank;
    const auto first = static_cast<std::uint32_t>(points.size());
    const Vec3 moved = bank.mass ? apart * (bank.mass->center_of_mass_m - centre) : Vec3{};
    for (const modal::Vec3f& p : bank.positions) points.push_back(seen_from_front(wide(p) + moved));
    for (const auto& [a, b, c] : bank.triangles) {
      triangles.push_back({first + a, first + b, first + c});
      owners.push_back(i);
    }
  }
  if (points.empty() || std::max(triangles.size(), points.size()) > kMaxDrawn) {
    const char* why = points.empty() ? "pieces without a surface" : "too many triangles to draw";
    canvas.text({box.x + box.width / 2, box.y + box.height / 2}, why, 12, kFaint, Align::centre);
    return;
  }
  Dot low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  points.push_back(seen_from_front(pattern.at_m));
  fit(points, box, low, high);
  draw_faces(canvas, points, triangles, [&](std::size_t t) {
    return pattern.pieces[owners[t]].bank.mode_count() == 0 ? kSilent : piece_colour(owners[t]);
  });
  if (apart == 0) mark(canvas, points.back());
}

}  // namespace ringdown::cli
