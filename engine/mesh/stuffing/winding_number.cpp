#include "engine/mesh/stuffing/winding_number.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

// A fast sum with a known error
//
// The triangles are sorted into a binary tree: each node splits its triangles in halves along the longest side of the
// box around their middles. Each node keeps the first three terms of the expansion of its triangles' solid angle about
// their common centre: the dipole, its gradient and its second derivatives (expand()).
//
// A query walks down the tree (sum()). A node whose radius is less than `opening` times its distance contributes its
// expansion, and the bound on the expansion's remainder is added to the error. Leaves are summed triangle by triangle.
// A smaller opening descends further and is more exact. at() and inside() begin with a wide opening and narrow it only
// until the error is small enough: for most points the first try tells inside from outside.
//
// Long, narrow triangles, such as those along the axis of a turned body, would make clusters as long as the body, which
// are never far away. So such triangles are first cut across (cut_across()), which does not change their solid angles.
namespace ringdown::mesh {
namespace {

using Eigen::Vector3d;

constexpr int kLeaf = 8;
constexpr double kLong = 8;                               // ratio of length to width from which triangles are cut
constexpr double kShortest = 1.0 / 64;                    // share of the diagonal; shorter triangles are not cut
constexpr std::array kOpenings = {0.6, 0.4, 0.25, 0.12};  // radius over distance, from cheap to exact

// The solid angle over 4 pi, by equation (8) of van Oosterom & Strackee.
double solid_angle(const std::array<Vector3d, 3>& triangle, const Vector3d& point) {
  const Vector3d a = triangle[0] - point, b = triangle[1] - point, c = triangle[2] - point;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return std::atan2(a.dot(b.cross(c)), below) / (2 * std::numbers::pi);
}

Vector3d area_of(const std::array<Vector3d, 3>& t) { return (t[1] - t[0]).cross(t[2] - t[0]) / 2; }

// Adds the triangle to `pieces`, cut into parts that are less than kLong times as long as wide or shorter than
// `shortest`, as long as there are fewer than `max` pieces.
void cut_across(const std::array<Vector3d, 3>& triangle, double shortest, std::size_t max,
                std::vector<std::array<Vector3d, 3>>& pieces) {
  int from = 0;
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const double length = (triangle[(k + 1) % 3] - triangle[k]).norm();
    if (length > longest) {
      longest = length;
      from = k;
    }
  }
  if (longest <= shortest || longest * longest < 2 * kLong * area_of(triangle).norm() || pieces.size() >= max) {
    if (area_of(triangle).norm() > 0) pieces.push_back(triangle);
    return;
  }
  const Vector3d &a = triangle[from], &b = triangle[(from + 1) % 3], &c = triangle[(from + 2) % 3];
  const Vector3d middle = (a + b) / 2;
  cut_across({a, middle, c}, shortest, max, pieces);
  cut_across({middle, b, c}, shortest, max, pieces);
}

// Returns true if a box meets the segment a + t d, 0 <= t <= 1.
bool meets(const Vector3d& low, const Vector3d& high, const Vector3d& a, const Vector3d& d) {
  double from = 0, to = 1;
  for (int k = 0; k < 3; ++k) {
    if (d[k] == 0) {
      if (a[k] < low[k] || a[k] > high[k]) return false;
      continue;
    }
    const double t0 = (low[k] - a[k]) / d[k], t1 = (high[k] - a[k]) / d[k];
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
  }
  return from <= to + 1e-12;
}

// Moeller & Trumbore, J. Graphics Tools 2, 1997, slightly widened so that no segment slips between two triangles.
double hit(const std::array<Vector3d, 3>& triangle, const Vector3d& a, const Vector3d& d) {
  constexpr double kHair = 1e-10;
  const Vector3d u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], p = d.cross(v);
  const double determinant = u.dot(p);
  if (determinant == 0) return -1;
  const Vector3d s = a - triangle[0], q = s.cross(u);
  const double x = s.dot(p) / determinant, y = d.dot(q) / determinant, t = v.dot(q) / determinant;
  return x >= -kHair && y >= -kHair && x + y <= 1 + kHair && t >= 0 && t <= 1 ? t : -1;
}

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& surface) {
  triangles_.reserve(surface.triangles.rows());
  if (surface.triangles.rows() == 0) return;
  const double shortest = kShortest * (surface.nodes.colwise().maxCoeff() - surface.nodes.colwise().minCoeff()).norm();
  const std::size_t max = 4 * surface.triangles.rows() + 10'000;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    Triangle triangle;
    for (int k = 0; k < 3; ++k) triangle[k] = surface.nodes.row(surface.triangles(t, k)).transpose();
    cut_across(triangle, shortest, max, triangles_);
  }
  nodes_.reserve(triangles_.size() / 2 + 1);
  if (triangles_.empty()) return;
  build(0, static_cast<int>(triangles_.size()));
  turned_ = faces_inward();
  if (!turned_) return;
  for (Triangle& triangle : triangles_) std::swap(triangle[1], triangle[2]);
  nodes_.clear();
  build(0, static_cast<int>(triangles_.size()));
}

// Returns true if the surface is inside out. The winding numbers on the two sides of a surface are 1 and 0 if the
// surface is turned outward, else 0 and -1. The sign of the volume would decide for a closed surface, but for an open
// surface that sign depends on the point from which the volume is measured.
bool WindingNumber::faces_inward() const {
  constexpr std::size_t kTriangles = 500;
  constexpr double kBeside = 1e-4;  // distance of test points, as a share of the triangle's size
  const std::size_t step = triangles_.size() / kTriangles + 1;
  double sum = 0;
  for (std::size_t t = 0; t < triangles_.size(); t += step) {
    const Triangle& triangle = triangles_[t];
    const Vector3d area = area_of(triangle), middle = (triangle[0] + triangle[1] + triangle[2]) / 3;
    const Vector3d beside = kBeside * std::sqrt(area.norm()) * area.normalized();
    sum += area.norm() * (at(middle + beside) + at(middle - beside));
  }
  return sum < 0;
}

int WindingNumber::build(int first, int count) {
  const int number = static_cast<int>(nodes_.size());
  Node node;
  node.first = first;
  node.count = count;
  node.low.setConstant(std::numeric_limits<double>::infinity());
  node.high = -node.low;
  Vector3d low = node.low, high = node.high;
  for (int t = first; t < first + count; ++t) {
    Vector3d middle = Vector3d::Zero();
    for (const Vector3d& corner : triangles_[t]) {
      node.low = node.low.cwiseMin(corner);
      node.high = node.high.cwiseMax(corner);
      middle += corner / 3;
    }
    low = low.cwiseMin(middle);
    high = high.cwiseMax(middle);
  }
  expand(node);
  nodes_.push_back(node);
  if (count <= kLeaf) return number;
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto begin = triangles_.begin() + first;
  std::stable_sort(begin, begin + count, [axis](const Triangle& a, const Triangle& b) {
    return a[0][axis] + a[1][axis] + a[2][axis] < b[0][axis] + b[1][axis] + b[2][axis];
  });
  build(first, count / 2);
  nodes_[number].right = build(first + count / 2, count - count / 2);
  return number;
}

// With y = x - centre: dipole_i = int n_i, gradient_ij = int n_i y_j, T_ijk = int n_i y_j y_k. Of T, only the parts
// that its contraction with the third derivatives of 1/r needs are kept: trace_k = 2 T_iik + T_kii, and the symmetric
// part.
void WindingNumber::expand(Node& node) const {
  double weight = 0;
  node.centre.setZero();
  for (int t = node.first; t < node.first + node.count; ++t) {
    const Triangle& triangle = triangles_[t];
    const double area = area_of(triangle).norm();
    node.centre += area / 3 * (triangle[0] + triangle[1] + triangle[2]);
    weight += area;
  }
  node.centre /= weight;
  node.dipole.setZero();
  node.trace.setZero();
  node.gradient.setZero();
  node.cubic.fill(0);
  for (int t = node.first; t < node.first + node.count; ++t) {
    const Vector3d n = area_of(triangles_[t]);
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // int y y^T over the area
    Vector3d all = Vector3d::Zero();
    double reach = 0;
    for (const Vector3d& corner : triangles_[t]) {
      const Vector3d y = corner - node.centre;
      second += y * y.transpose() / 12;
      all += y;
      reach = std::max(reach, y.norm());
    }
    second += all * all.transpose() / 12;
    node.radius = std::max(node.radius, reach);
    node.third += n.norm() * reach * reach * reach;
    node.dipole += n;
    node.gradient += n * all.transpose() / 3;
    node.trace += 2 * second * n + second.trace() * n;
    auto& c = node.cubic;
    for (int i = 0; i < 3; ++i) c[i] += n[i] * second(i, i);
    constexpr int kPairs[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}};
    for (int p = 0; p < 6; ++p) {
      const auto [i, j] = kPairs[p];
      c[3 + p] += n[j] * second(i, i) + 2 * n[i] * second(i, j);
    }
    c[9] += 2 * (n[0] * second(1, 2) + n[1] * second(0, 2) + n[2] * second(0, 1));
  }
}

// `offset` leads from the point to the centre. Error bound: the term of degree m of n . grad(1/r) is at most
// (m + 1) |y|^m / r^(m+2), because a zonal harmonic is steepest on its axis.
WindingNumber::Bounded WindingNumber::far_field(const Node& node, const Vector3d& offset, double distance) {
  const double r2 = distance * distance, r3 = r2 * distance, r5 = r3 * r2, r7 = r5 * r2;
  const double x = offset[0], y = offset[1], z = offset[2];
  const auto& c = node.cubic;
  double value = node.dipole.dot(offset) / r3;
  value += node.gradient.trace() / r3 - 3 * offset.dot(node.gradient * offset) / r5;
  const double cubic = c[0] * x * x * x + c[1] * y * y * y + c[2] * z * z * z + c[3] * x * x * y + c[4] * x * x * z +
                       c[5] * y * y * x + c[6] * y * y * z + c[7] * z * z * x + c[8] * z * z * y + c[9] * x * y * z;
  value += 0.5 * (15 * cubic / r7 - 3 * node.trace.dot(offset) / r5);
  const double near = node.radius / distance;
  const double error = node.third / r5 * (4 - 3 * near) / ((1 - near) * (1 - near));
  return {value / (4 * std::numbers::pi), error / (4 * std::numbers::pi)};
}

// Calls leaf(triangle) for the triangles of every node that enter() lets pass together with all nodes above it.
template <class Enter, class Leaf>
void WindingNumber::descend(const Enter& enter, const Leaf& leaf) const {
  std::array<int, 64> waiting;
  int depth = 0;
  if (!nodes_.empty()) waiting[depth++] = 0;
  while (depth > 0) {
    const int number = waiting[--depth];
    const Node& node = nodes_[number];
    if (!enter(node)) continue;
    if (node.right == 0) {
      for (int t = node.first; t < node.first + node.count; ++t) leaf(triangles_[t]);
    } else {
      waiting[depth++] = node.right;
      waiting[depth++] = number + 1;
    }
  }
}

// Clusters smaller than `opening` times their distance are replaced by their expansions.
WindingNumber::Bounded WindingNumber::sum(const Vector3d& point, double opening) const {
  Bounded total{0, 0};
  const auto enter = [&](const Node& node) {
    const Vector3d offset = node.centre - point;
    const double distance = offset.norm();
    if (node.count <= 2 || !(node.radius < opening * distance)) return true;
    const Bounded part = far_field(node, offset, distance);
    total.value += part.value;
    total.error += part.error;
    return false;
  };
  descend(enter, [&](const Triangle& triangle) { total.value += solid_angle(triangle, point); });
  return total;
}

double WindingNumber::at(const Vector3d& point, double tolerance) const {
  for (const double opening : kOpenings) {
    if (tolerance <= 0) break;
    const Bounded found = sum(point, opening);
    if (found.error <= tolerance) return found.value;
  }
  return sum(point, 0).value;
}

bool WindingNumber::inside(const Vector3d& point) const {
  for (const double opening : kOpenings) {
    const Bounded found = sum(point, opening);
    if (std::abs(found.value - 0.5) > found.error || found.error < 1e-4) return found.value > 0.5;
  }
  return sum(point, 0).value > 0.5;
}

std::vector<double> WindingNumber::crossings(const Vector3d& a, const Vector3d& b) const {
  std::vector<double> found;
  const Vector3d d = b - a;
  descend([&](const Node& node) { return meets(node.low, node.high, a, d); },
          [&](const Triangle& triangle) {
            if (const double at = hit(triangle, a, d); at >= 0) found.push_back(at);
          });
  std::sort(found.begin(), found.end());
  return found;
}

bool WindingNumber::near(const Vector3d& low, const Vector3d& high) const {
  const auto meets_box = [&](const Vector3d& min, const Vector3d& max) {
    return (min.array() <= high.array()).all() && (max.array() >= low.array()).all();
  };
  bool found = false;
  descend([&](const Node& node) { return !found && meets_box(node.low, node.high); },
          [&](const Triangle& triangle) {
            const auto& [p, q, r] = triangle;
            found = found || meets_box(p.cwiseMin(q).cwiseMin(r), p.cwiseMax(q).cwiseMax(r));
          });
  return found;
}

bool WindingNumber::normal_at(const Vector3d& point, double reach, Vector3d& normal) const {
  double nearest = reach;
  bool found = false;
  const auto enter = [&](const Node& node) {
    return ((node.low - point).array() <= reach).all() && ((point - node.high).array() <= reach).all();
  };
  descend(enter, [&](const Triangle& triangle) {
    const auto& [p, q, r] = triangle;
    const Vector3d area = area_of(triangle), unit = area.normalized();
    const double off = std::abs(unit.dot(point - p)), twice = 2 * area.norm();
    constexpr double kHair = -1e-3;
    if (off > nearest || unit.dot((q - p).cross(point - p)) < kHair * twice ||
        unit.dot((r - q).cross(point - q)) < kHair * twice || unit.dot((p - r).cross(point - r)) < kHair * twice) {
      return;
    }
    nearest = off;
    normal = unit;
    found = true;
  });
  return found;
}

}  // namespace ringdown::mesh
