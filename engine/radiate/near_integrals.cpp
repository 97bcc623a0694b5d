#include "engine/radiate/near_integrals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace ringdown::radiate {
namespace {

// The solid angle of a triangle. `volume` is six times that of the tetrahedron between the point and the triangle.
double solid_angle(const std::array<Eigen::Vector3d, 3>& corners, const Eigen::Vector3d& point, double volume) {
  const Eigen::Vector3d a = corners[0] - point, b = corners[1] - point, c = corners[2] - point;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(volume, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

// Let rho be the point's foot in the triangle's plane and d its height. An edge from a to b with tangent l and outward
// normal u in the plane has s = (end - rho).l at its ends, t = (end - rho).u, and R at its ends. With
//
//   f = integral along the edge of 1/R = ln((R_b + s_b) / (R_a + s_a))
//   R0^2 = t^2 + d^2
//
// With the solid angle omega of the triangle (van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 1983, 125), the
// integral of 1/R is the sum over the edges of t f, minus |d| omega. The integral of d/R^3 is sign(d) omega. The
// integral of (y - rho)/R is 1/2 sum of u (R0^2 f + s_b R_b - s_a R_a). By Gauss's theorem, gradient(hat) * (integral
// of 1/R) - sum of u * (integral of hat/R along the edge) is the integral of hat (y - rho)/R^3.
TrianglePotential potential_of(const Panels& panels, int triangle, const Eigen::Vector3d& point) {
  const Eigen::Vector3d& n = panels.normals[triangle];
  const std::array<Eigen::Vector3d, 3> p = {panels.corner(triangle, 0), panels.corner(triangle, 1),
                                            panels.corner(triangle, 2)};
  const double scale = std::sqrt(panels.areas[triangle]);
  const double d = (point - p[0]).dot(n), height = std::abs(d);
  const Eigen::Vector3d foot = point - d * n;
  const double angle = solid_angle(p, point, 2 * panels.areas[triangle] * height);  // integral of |d|/R^3
  double inverse = 0;                                                               // integral of 1/R
  Eigen::Vector3d moment = Eigen::Vector3d::Zero(), rim = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 3> hat_rim = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int e = 0; e < 3; ++e) {
    const int from = e, to = (e + 1) % 3;
    Eigen::Vector3d along = p[to] - p[from];
    const double length = along.norm();
    along /= length;
    const Eigen::Vector3d outward = along.cross(n);
    const double sa = (p[from] - foot).dot(along), sb = (p[to] - foot).dot(along), t = (p[from] - foot).dot(outward);
    const double r0 = t * t + d * d, ra = std::sqrt(r0 + sa * sa), rb = std::sqrt(r0 + sb * sb);
    double f = 0;
    if (r0 > 1e-24 * scale * scale) {  // the form of ln that does not cancel
      f = sa > 0   ? std::log((rb + sb) / (ra + sa))
          : sb < 0 ? std::log((ra - sa) / (rb - sb))
                   : std::log((rb + sb) * (ra - sa) / r0);
    } else if (sa * sb > 0) {
      f = std::abs(std::log(sb / sa));
    }
    inverse += t * f;
    moment += outward * (0.5 * (r0 * f + sb * rb - sa * ra));
    rim += outward * f;
    const double at_start = -sa / length;  // position of the point's foot along the edge
    hat_rim[from] += outward * ((1 - at_start) * f - (rb - ra) / length);
    hat_rim[to] += outward * (at_start * f + (rb - ra) / length);
  }
  inverse -= height * angle;
  const double side = d > 0 ? 1 : d < 0 ? -1 : 0;
  TrianglePotential potential;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d slope = panels.curls[triangle][i].cross(n);  // the hat's gradient: curl = n x gradient
    const double at_foot = 1 + slope.dot(foot - p[i]);
    potential.value[i] = at_foot * inverse + slope.dot(moment);
    const double normal_part = at_foot * side * angle - d * slope.dot(rim);
    potential.gradient[i] = slope * inverse - hat_rim[i] - n * normal_part;
  }
  return potential;
}

namespace {

struct OuterPoint {
  std::array<double, 3> at;  // barycentric
  double weight;             // share of the area
};

// Seven points, exact to degree 5: Radon, 1948.
std::vector<OuterPoint> seven_points() {
  const double root = std::sqrt(15.0), a = (6 - root) / 21, b = (6 + root) / 21;
  const double wa = (155 - root) / 1200, wb = (155 + root) / 1200;
  return {{{1 / 3.0, 1 / 3.0, 1 / 3.0}, 9 / 40.0},
          {{a, a, 1 - 2 * a}, wa},
          {{a, 1 - 2 * a, a}, wa},
          {{1 - 2 * a, a, a}, wa},
          {{b, b, 1 - 2 * b}, wb},
          {{b, 1 - 2 * b, b}, wb},
          {{1 - 2 * b, b, b}, wb}};
}

// Three points, exact to degree 2.
std::vector<OuterPoint> three_points() {
  const double a = 1 / 6.0, b = 2 / 3.0, third = 1 / 3.0;
  return {{{b, a, a}, third}, {{a, b, a}, third}, {{a, a, b}, third}};
}

// Applies a rule to each of the four triangles that the middles of the sides form.
std::vector<OuterPoint> divided(const std::vector<OuterPoint>& rule) {
  const double h = 0.5;
  const double corners[4][3][3] = {{{1, 0, 0}, {h, h, 0}, {h, 0, h}},
                                   {{h, h, 0}, {0, 1, 0}, {0, h, h}},
                                   {{h, 0, h}, {0, h, h}, {0, 0, 1}},
                                   {{h, h, 0}, {0, h, h}, {h, 0, h}}};
  std::vector<OuterPoint> points;
  for (const auto& part : corners) {
    for (const OuterPoint& point : rule) {
      OuterPoint inside{{0, 0, 0}, point.weight / 4};
      for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < 3; ++i) inside.at[i] += point.at[c] * part[c][i];
      }
      points.push_back(inside);
    }
  }
  return points;
}

// A part of a surface and one of its images.
struct Facing {
  const Panels &panels, &others;
  bool same = false;  // the image is the part itself
};

// Finds, for each triangle of one surface, the triangles of another that are near it, by a grid of cells as wide as the
// search.
class NearbyTriangles {
 public:
  explicit NearbyTriangles(const Facing& facing) : facing_(facing) {
    const auto& [panels, others, same] = facing;
    for (int t = 0; t < panels.triangle_count(); ++t) longest_.push_back(panels.longest_side(t));  // images' are equal
    cell_ = kNearSides * *std::max_element(longest_.begin(), longest_.end());
    for (int t = 0; t < others.triangle_count(); ++t) cells_[cell_of(others.centers[t])].push_back(t);
  }
  template <class Visit>
  void visit(int triangle, const Visit& visit) const {
    const auto middle = cell_of(facing_.panels.centers[triangle]);
    for (int n = 0; n < 27; ++n) {
      const auto found = cells_.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
      if (found == cells_.end()) continue;
      for (const int other : found->second) {
        const double reach = kNearSides * std::max(longest_[triangle], longest_[other]);
        if ((facing_.others.centers[other] - facing_.panels.centers[triangle]).squaredNorm() < reach * reach)
          visit(other);
      }
    }
  }

 private:
  [[nodiscard]] std::array<int, 3> cell_of(const Eigen::Vector3d& at) const {
    return {static_cast<int>(std::floor(at[0] / cell_)), static_cast<int>(std::floor(at[1] / cell_)),
            static_cast<int>(std::floor(at[2] / cell_))};
  }
  const Facing& facing_;
  double cell_ = 1;
  std::vector<double> longest_;
  std::map<std::array<int, 3>, std::vector<int>> cells_;
};

struct PairIntegrals {
  double constant = 0;           // integral of 1/R
  Eigen::Matrix3d hats, slopes;  // integrals of hat(x) hat(y)/R and of hat(x) hat(y) d/dn(x) 1/R
};

void add_exact(const Facing& facing, int x, int y, const std::vector<OuterPoint>& rule, PairIntegrals& sum) {
  const auto& [panels, others, same] = facing;
  for (const OuterPoint& point : rule) {
    const Eigen::Vector3d at =
        point.at[0] * panels.corner(x, 0) + point.at[1] * panels.corner(x, 1) + point.at[2] * panels.corner(x, 2);
    const TrianglePotential potential = potential_of(others, y, at);
    const double weight = point.weight * panels.areas[x];
    sum.constant += weight * (potential.value[0] + potential.value[1] + potential.value[2]);
    for (int j = 0; j < 3; ++j) {
      const double slope = same && x == y ? 0 : potential.gradient[j].dot(panels.normals[x]);
      for (int i = 0; i < 3; ++i) {
        sum.hats(i, j) += weight * point.at[i] * potential.value[j];
        sum.slopes(i, j) += weight * point.at[i] * slope;
      }
    }
  }
}

void subtract_middles(const Facing& facing, int x, int y, PairIntegrals& sum) {
  const auto& [panels, others, same] = facing;
  const double weight = panels.areas[x] * others.areas[y] / 9;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      const Eigen::Vector3d between =
          panels.sides[panels.sides_of[x][a]].middle - others.sides[others.sides_of[y][b]].middle;
      if (between.isZero(0)) continue;
      const double r = between.norm(), slope = -between.dot(panels.normals[x]) / (r * r * r);
      sum.constant -= weight / r;
      for (int i = 0; i < 3; ++i) {
        if (i == a) continue;  // on a side, the hat of the opposite corner is 0, the others are 1/2
        for (int j = 0; j < 3; ++j) {
          if (j == b) continue;
          sum.hats(i, j) -= 0.25 * weight / r;
          sum.slopes(i, j) -= 0.25 * weight * slope;
        }
      }
    }
  }
}

// Allocates, for each node, an entry for every node of the triangles near its own, in ascending order.
NearIntegrals without_values(const Facing& facing, const std::vector<std::vector<int>>& near_triangles) {
  const auto& [panels, others, same] = facing;
  std::vector<std::vector<int>> own(panels.node_count());
  for (int t = 0; t < panels.triangle_count(); ++t) {
    for (const int n : panels.corners[t]) own[n].push_back(t);
  }
  NearIntegrals near;
  near.begin.push_back(0);
  std::vector<int> seen(panels.node_count(), -1);
  for (int row = 0; row < panels.node_count(); ++row) {
    for (const int x : own[row]) {
      for (const int y : near_triangles[x]) {
        for (const int column : others.corners[y]) {
          if (std::exchange(seen[column], row) != row) near.columns.push_back(column);
        }
      }
    }
    std::sort(near.columns.begin() + near.begin.back(), near.columns.end());
    near.begin.push_back(static_cast<int>(near.columns.size()));
  }
  near.entries.resize(near.columns.size());
  return near;
}

}  // namespace

NearIntegrals near_integrals(const Panels& panels, int image) {
  const Panels others = image_of(panels, image);
  const std::vector<OuterPoint> few = three_points(), rule = seven_points(), fine = divided(rule);
  const Facing facing{panels, others, image == 0};
  const NearbyTriangles nearby(facing);
  std::vector<std::vector<int>> near_triangles(panels.triangle_count());
  for (int x = 0; x < panels.triangle_count(); ++x) nearby.visit(x, [&](int y) { near_triangles[x].push_back(y); });
  NearIntegrals near = without_values(facing, near_triangles);
  for (int x = 0; x < panels.triangle_count(); ++x) {
    for (const int y : near_triangles[x]) {
      PairIntegrals pair;
      pair.hats.setZero();
      pair.slopes.setZero();
      const double away = (panels.centers[x] - others.centers[y]).norm() / panels.longest_side(x);
      add_exact(facing, x, y, away < 0.7 ? fine : away < 1.4 ? rule : few, pair);
      subtract_middles(facing, x, y, pair);
      const double over = 1 / (4 * std::numbers::pi), across = panels.normals[x].dot(others.normals[y]);
      for (int i = 0; i < 3; ++i) {
        const auto first = near.columns.begin() + near.begin[panels.corners[x][i]],
                   last = near.columns.begin() + near.begin[panels.corners[x][i] + 1];
        for (int j = 0; j < 3; ++j) {
          const auto at = std::lower_bound(first, last, others.corners[y][j]) - near.columns.begin();
          const double curl = panels.curls[x][i].dot(others.curls[y][j]);
          near.entries[at].curls += static_cast<float>(over * curl * pair.constant);
          near.entries[at].normals += static_cast<float>(over * across * pair.hats(i, j));
          near.entries[at].slopes += static_cast<float>(over * pair.slopes(i, j));
        }
      }
    }
  }
  return near;
}

}  // namespace ringdown::radiate
