#include "engine/mesh/files/triangle_soup.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

// Cutting polygons
//
// A polygon is seen along its normal, by Newell's sum over its sides, so that it runs counter-clockwise in a plane. One
// that turns left at every corner becomes a fan. Of another one, ears are cut off one after the other: a corner that
// turns left, and whose triangle with its two neighbours holds no other corner (Meisters 1975). Corners in the middle
// of a straight side belong to a triangle, too, because the polygon beyond that side may have them. Where no ear is
// left, as in a polygon that cuts itself, any corner is cut off.
namespace ringdown::mesh {
namespace {

using Point2 = Eigen::Vector2d;

double turn_of(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// The corners in the plane of the polygon, scaled to its size.
std::vector<Point2> flattened(const TriangleSoup& soup, std::span<const std::int32_t> corners) {
  const auto at = [&](std::size_t k) -> const Eigen::RowVector3d& {
    return soup.points[static_cast<std::size_t>(corners[k % corners.size()])];
  };
  const Eigen::RowVector3d origin = at(0);
  Eigen::RowVector3d normal = Eigen::RowVector3d::Zero();
  double size = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    normal += (at(k) - origin).cross(at(k + 1) - origin);
    size = std::max(size, (at(k) - origin).norm());
  }
  std::vector<Point2> flat(corners.size(), Point2::Zero());
  if (!(normal.stableNorm() > 0) || !(size > 0)) return flat;
  normal.stableNormalize();
  const Eigen::RowVector3d x = normal.unitOrthogonal(), y = normal.cross(x);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::RowVector3d from = (at(k) - origin) / size;
    flat[k] = {from.dot(x), from.dot(y)};
  }
  return flat;
}

class EarCutter {
 public:
  EarCutter(TriangleSoup& soup, std::span<const std::int32_t> corners)
      : soup_(soup), corners_(corners), at_(flattened(soup, corners)) {
    for (std::size_t k = 0; k < corners.size(); ++k) left_.push_back(k);
  }

  void cut() {
    bool convex = true;
    for (std::size_t k = 0; k < left_.size(); ++k) convex = convex && turn_at(k) > kStraightTurn;
    std::size_t next = convex ? 1 : 0, failed = 0;
    while (left_.size() > 3) {
      if (convex || is_ear(next) || failed == left_.size()) {
        put(next);
        left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(next));
        failed = 0;
        next = convex ? 1 : next % left_.size();
      } else {
        next = (next + 1) % left_.size();
        ++failed;
      }
    }
    put(1);
  }

 private:
  static constexpr double kStraightTurn = 1e-12;  // of the polygon's size, squared

  [[nodiscard]] std::size_t before(std::size_t k) const { return left_[(k + left_.size() - 1) % left_.size()]; }
  [[nodiscard]] std::size_t after(std::size_t k) const { return left_[(k + 1) % left_.size()]; }
  [[nodiscard]] double turn_at(std::size_t k) const { return turn_of(at_[before(k)], at_[left_[k]], at_[after(k)]); }

  [[nodiscard]] bool is_ear(std::size_t k) const {
    if (!(turn_at(k) > kStraightTurn)) return false;
    const Point2 &a = at_[before(k)], &b = at_[left_[k]], &c = at_[after(k)];
    return std::ranges::none_of(left_, [&](std::size_t other) {
      const Point2& p = at_[other];
      if (p == a || p == b || p == c) return false;
      return turn_of(a, b, p) >= 0 && turn_of(b, c, p) >= 0 && turn_of(c, a, p) >= -kStraightTurn;
    });
  }

  void put(std::size_t k) { soup_.triangles.push_back({corners_[before(k)], corners_[left_[k]], corners_[after(k)]}); }

  TriangleSoup& soup_;
  std::span<const std::int32_t> corners_;
  std::vector<Point2> at_;
  std::vector<std::size_t> left_;  // the corners that are not cut off
};

}  // namespace

double float_spacing(double size) {
  const auto there = static_cast<float>(size);
  return std::nextafter(there, std::numeric_limits<float>::infinity()) - there;
}

double float_spacing(const std::vector<Eigen::RowVector3d>& points) {
  double largest = 0;
  for (const Eigen::RowVector3d& at : points) largest = std::max(largest, at.cwiseAbs().maxCoeff());
  return float_spacing(largest);
}

void add_polygon(TriangleSoup& soup, std::span<const std::int32_t> corners) {
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    soup.triangles.push_back({corners[0], corners[1], corners[2]});
  } else {
    EarCutter(soup, corners).cut();
  }
}

}  // namespace ringdown::mesh
