#include "engine/mesh/shells.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

// Finding shells
//
// Triangles are linked through the edges that exactly two of them have. From each triangle that belongs to no shell
// yet, a breadth-first search collects everything it is linked to: that is one shell. Each step knows whether the next
// triangle runs the same way round as its neighbour, so every triangle is marked as turned or not relative to the
// first; if the turned ones have more than half of the area, the marks are exchanged. Volume follows from the
// tetrahedra between the triangles and one point. A shell lies inside another when that one's winding number around its
// first node is not 0.
namespace ringdown::mesh {
namespace {

using Node = Eigen::RowVector3d;

// The solid angle of a triangle from `eye`, over 4 pi (van Oosterom & Strackee, IEEE Trans. Biomed. Eng. 30, 1983).
double winding(const Node& eye, const Node& a, const Node& b, const Node& c) {
  const Node u = a - eye, v = b - eye, w = c - eye;
  const double lu = u.norm(), lv = v.norm(), lw = w.norm();
  const double over = u.dot(v.cross(w)), under = lu * lv * lw + u.dot(v) * lw + v.dot(w) * lu + w.dot(u) * lv;
  return std::atan2(over, under) / (2 * std::numbers::pi);
}

class Grower {
 public:
  Grower(const TriangleMesh& mesh, const std::vector<bool>& usable) : mesh_(mesh), edges_(edges_of(mesh, usable)) {
    const auto count = static_cast<std::size_t>(mesh.triangles.rows());
    shells_.shell.assign(count, -1);
    shells_.turned.assign(count, false);
    link(count);
    for (std::size_t t = 0; t < count; ++t) {
      if (usable[t] && shells_.shell[t] < 0) grow(static_cast<std::int32_t>(t));
    }
    mark_open();
    nest();
  }

  Shells take() { return std::move(shells_); }

 private:
  struct Link {
    std::int32_t triangle;
    bool agrees;  // both run through the edge in opposite directions
  };

  void link(std::size_t count) {
    links_.resize(count);
    for (std::size_t first = 0, last; first < edges_.size(); first = last) {
      last = end_of_edge(edges_, first);
      if (last - first != 2) continue;
      const EdgeUse &a = edges_[first], &b = edges_[first + 1];
      const bool agrees = a.forward != b.forward;
      links_[static_cast<std::size_t>(a.triangle)].push_back({b.triangle, agrees});
      links_[static_cast<std::size_t>(b.triangle)].push_back({a.triangle, agrees});
    }
  }

  [[nodiscard]] Node at(std::int32_t t, int corner) const { return mesh_.nodes.row(mesh_.triangles(t, corner)); }

  void grow(std::int32_t seed) {
    const int number = shells_.count++;
    std::vector<std::int32_t> members = {seed};
    shells_.shell[static_cast<std::size_t>(seed)] = number;
    double area = 0, turned_area = 0, volume = 0;
    for (std::size_t next = 0; next < members.size(); ++next) {
      const std::int32_t t = members[next];
      const bool turned = shells_.turned[static_cast<std::size_t>(t)];
      const Node a = at(t, 0), b = at(t, 1), c = at(t, 2);
      const double part = 0.5 * (b - a).cross(c - a).norm();
      area += part;
      turned_area += turned ? part : 0;
      const Node origin = at(seed, 0);
      volume += (turned ? -1 : 1) * (a - origin).dot((b - origin).cross(c - origin)) / 6;
      for (const auto& [other, agrees] : links_[static_cast<std::size_t>(t)]) {
        const auto o = static_cast<std::size_t>(other);
        if (shells_.shell[o] >= 0) continue;
        shells_.shell[o] = number;
        shells_.turned[o] = agrees ? turned : !turned;
        members.push_back(other);
      }
    }
    if (turned_area > 0.5 * area) {
      for (const std::int32_t t : members) shells_.turned[static_cast<std::size_t>(t)].flip();
      volume = -volume;
    }
    shells_.volume_m3.push_back(volume);
    shells_.area_m2.push_back(area);
  }

  void mark_open() {
    shells_.closed.assign(static_cast<std::size_t>(shells_.count), true);
    for (std::size_t first = 0, last; first < edges_.size(); first = last) {
      last = end_of_edge(edges_, first);
      if (last - first == 2) continue;
      for (std::size_t e = first; e < last; ++e) {
        shells_.closed[static_cast<std::size_t>(shells_.shell[static_cast<std::size_t>(edges_[e].triangle)])] = false;
      }
    }
  }

  void nest() {
    const auto count = static_cast<std::size_t>(shells_.count);
    shells_.depth.assign(count, 0);
    shells_.parent.assign(count, -1);
    if (count < 2 || count > kMaxShells) return;
    std::vector<std::vector<std::int32_t>> members(count);
    for (std::size_t t = 0; t < shells_.shell.size(); ++t) {
      if (shells_.shell[t] >= 0)
        members[static_cast<std::size_t>(shells_.shell[t])].push_back(static_cast<std::int32_t>(t));
    }
    std::vector<std::vector<std::size_t>> around(count);
    for (std::size_t inner = 0; inner < count; ++inner) {
      const Node eye = at(members[inner].front(), 0);
      for (std::size_t outer = 0; outer < count; ++outer) {
        if (outer == inner || !shells_.closed[outer]) continue;
        double sum = 0;
        for (const std::int32_t t : members[outer]) {
          const double part = winding(eye, at(t, 0), at(t, 1), at(t, 2));
          sum += shells_.turned[static_cast<std::size_t>(t)] ? -part : part;
        }
        if (std::abs(sum) > 0.5) around[inner].push_back(outer);
      }
      shells_.depth[inner] = static_cast<int>(around[inner].size());
    }
    for (std::size_t inner = 0; inner < count; ++inner) {
      for (const std::size_t outer : around[inner]) {
        if (shells_.depth[outer] == shells_.depth[inner] - 1) shells_.parent[inner] = static_cast<int>(outer);
      }
    }
  }

  const TriangleMesh& mesh_;
  std::vector<EdgeUse> edges_;
  std::vector<std::vector<Link>> links_;
  Shells shells_;
};

}  // namespace

Shells shells_of(const TriangleMesh& mesh) { return Grower(mesh, usable_triangles(mesh)).take(); }

}  // namespace ringdown::mesh
