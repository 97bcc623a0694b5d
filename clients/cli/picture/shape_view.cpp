#include "clients/cli/picture/shape_view.h"

#include "clients/cli/picture/answer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace ringdown::cli {
namespace {

constexpr double kBend = 0.08;  // largest displacement, of the body's size

struct View {
  std::vector<Vec3> points;  // x, y on the sheet; z towards the eye, in the body's units
  std::vector<double> move;  // 0 ... 1
};

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
    low[0] = std::min(low[0], view.points[p].x), high[0] = std::max(high[0], view.points[p].x);
    low[1] = std::min(low[1], view.points[p].y), high[1] = std::max(high[1], view.points[p].y);
  }
  const double width = std::max(high[0] - low[0], 1e-9), height = std::max(high[1] - low[1], 1e-9);
  const double scale = 0.9 * std::min(box.width / width, box.height / height);
  for (Vec3& p : view.points) {
    p.x = box.x + box.width / 2 + scale * (p.x - (low[0] + high[0]) / 2);
    p.y = box.y + box.height / 2 - scale * (p.y - (low[1] + high[1]) / 2);
    p.z *= scale;
  }
  return view;
}

void draw_points(Canvas& canvas, const View& view) {
  for (std::size_t p = 0; p < view.points.size(); ++p) {
    canvas.disc({view.points[p].x, view.points[p].y}, 4, heat(view.move[p]));
  }
}

// Grown by a little, or the paper would shine through between neighbours.
std::array<Dot, 3> corners_of(const View& view, const std::array<std::uint32_t, 3>& triangle) {
  constexpr double kGrow = 0.6;  // pixels
  std::array<Dot, 3> corners;
  Dot middle{0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = {view.points[triangle[k]].x, view.points[triangle[k]].y};
    middle = {middle.x + corners[k].x / 3, middle.y + corners[k].y / 3};
  }
  for (Dot& corner : corners) {
    const double x = corner.x - middle.x, y = corner.y - middle.y, size = std::max(std::hypot(x, y), 1e-9);
    corner = {corner.x + kGrow * x / size, corner.y + kGrow * y / size};
  }
  return corners;
}

// The farthest first. A face that looks away is seen from inside, where the body is open or thin: a little darker.
void draw_faces(Canvas& canvas, const View& view, const modal::Bank& bank) {
  std::vector<std::size_t> order(bank.triangles.size());
  std::iota(order.begin(), order.end(), 0);
  const auto depth = [&](std::size_t t) {
    const auto& [a, b, c] = bank.triangles[t];
    return view.points[a].z + view.points[b].z + view.points[c].z;
  };
  std::ranges::stable_sort(order, {}, depth);
  for (const std::size_t t : order) {
    const auto& [a, b, c] = bank.triangles[t];
    const Vec3 u = view.points[b] - view.points[a], v = view.points[c] - view.points[a];
    const Vec3 normal = cross(u, v);
    const double size = length(normal);
    const double facing = size > 0 ? std::abs(normal.z) / size : 1;
    const double light = 0.62 + 0.38 * facing;
    Colour colour = heat((view.move[a] + view.move[b] + view.move[c]) / 3);
    colour = {light * colour.red, light * colour.green, light * colour.blue};
    canvas.area(corners_of(view, bank.triangles[t]), colour);
  }
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
  bank.triangles.empty() ? draw_points(canvas, view) : draw_faces(canvas, view, bank);
  if (struck) {
    const Dot place{view.points[*struck].x, view.points[*struck].y};
    canvas.disc(place, 5, kPaper);
    canvas.disc(place, 3.5, kOrange);
  }
}

}  // namespace ringdown::cli
