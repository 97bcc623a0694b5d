#include "engine/radiate/surface_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ringdown::radiate {
namespace {

constexpr double kFacing = 0.5;
constexpr int kMaxCells = 96;  // limit along each axis

// The point of a triangle nearest to p. (Ericson, Real-Time Collision Detection, 2005, section 5.1.5.)
NearestPoint nearest_on(const Panels& panels, int triangle, const Eigen::Vector3d& p) {
  const Eigen::Vector3d a = panels.corner(triangle, 0), b = panels.corner(triangle, 1), c = panels.corner(triangle, 2);
  const auto place = [&](double u, double v, double w) {
    return NearestPoint{triangle, {u, v, w}, u * a + v * b + w * c};
  };
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return place(1, 0, 0);
  if (d3 >= 0 && d4 <= d3) return place(0, 1, 0);
  if (d6 >= 0 && d5 <= d6) return place(0, 0, 1);
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return place(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return place(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return place(0, 1 - w, w);
  }
  const double all = va + vb + vc;
  return place(va / all, vb / all, vc / all);
}

}  // namespace

SurfaceSearch::SurfaceSearch(const Panels& panels) : panels_(panels) {
  low_ = panels.nodes.colwise().minCoeff().transpose();
  const Eigen::Vector3d size = panels.nodes.colwise().maxCoeff().transpose() - low_;
  double side = std::sqrt(panels.area() / panels.triangle_count()) * 2;
  side = std::max(side, size.maxCoeff() / kMaxCells);
  cell_ = side;
  for (int c = 0; c < 3; ++c) count_[c] = static_cast<int>(size[c] / cell_) + 1;
  triangles_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
  for (int t = 0; t < panels.triangle_count(); ++t) {
    Eigen::Vector3d low = panels.corner(t, 0), high = low;
    for (int i = 1; i < 3; ++i) {
      low = low.cwiseMin(panels.corner(t, i));
      high = high.cwiseMax(panels.corner(t, i));
    }
    double radius = 0;
    for (int i = 0; i < 3; ++i) radius = std::max(radius, (panels.corner(t, i) - panels.centers[t]).norm());
    radii_.push_back(radius);
    const auto from = cell_of(low), to = cell_of(high);
    for (int x = from[0]; x <= to[0]; ++x) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int z = from[2]; z <= to[2]; ++z) triangles_[number_of(x, y, z)].push_back(t);
      }
    }
  }
}

std::array<int, 3> SurfaceSearch::cell_of(const Eigen::Vector3d& point) const {
  std::array<int, 3> cell{};
  for (int c = 0; c < 3; ++c) {
    cell[c] = static_cast<int>(std::clamp(std::floor((point[c] - low_[c]) / cell_), 0.0, count_[c] - 1.0));
  }
  return cell;
}

std::size_t SurfaceSearch::number_of(int x, int y, int z) const {
  return (static_cast<std::size_t>(x) * count_[1] + y) * count_[2] + z;
}

// Searches shells of cells around the point's own cell, until the next shell cannot contain a nearer place. Skips a
// triangle if the circle around its centre is farther than the best place so far.
NearestPoint SurfaceSearch::nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const auto own = cell_of(point);
  NearestPoint facing, any;
  double facing_at = std::numeric_limits<double>::infinity(), any_at = facing_at;
  const int max = *std::max_element(count_.begin(), count_.end());
  for (int shell = 0; shell <= max; ++shell) {
    double reached = std::numeric_limits<double>::infinity();  // no triangle of this shell is nearer
    for (int c = 0; c < 3; ++c) {
      const double inside = point[c] - low_[c] - own[c] * cell_;
      reached = std::min(reached, (shell - 1) * cell_ + std::min(inside, cell_ - inside));
    }
    if (facing_at <= reached || any_at + cell_ <= reached) break;
    for (int x = std::max(0, own[0] - shell); x <= std::min(count_[0] - 1, own[0] + shell); ++x) {
      for (int y = std::max(0, own[1] - shell); y <= std::min(count_[1] - 1, own[1] + shell); ++y) {
        for (int z = std::max(0, own[2] - shell); z <= std::min(count_[2] - 1, own[2] + shell); ++z) {
          if (std::max({std::abs(x - own[0]), std::abs(y - own[1]), std::abs(z - own[2])}) != shell) continue;
          for (const int t : triangles_[number_of(x, y, z)]) {
            const bool faces = panels_.normals[t].dot(normal) > kFacing;
            const double reach = (faces ? facing_at : any_at) + radii_[t];
            if ((panels_.centers[t] - point).squaredNorm() > reach * reach) continue;
            const NearestPoint place = nearest_on(panels_, t, point);
            const double away = (place.at - point).norm();
            if (away < any_at) {
              any_at = away;
              any = place;
            }
            if (faces && away < facing_at) {
              facing_at = away;
              facing = place;
            }
          }
        }
      }
    }
  }
  return facing_at <= any_at + cell_ ? facing : any;
}

}  // namespace ringdown::radiate
