#include "engine/radiate/retile.h"

#include "engine/radiate/panels.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>

namespace ringdown::radiate {
namespace {

using Vector = Eigen::Vector3d;
using Triangle = std::array<int, 3>;

constexpr double kCosSharp = 0.766;     // 40 degrees between the normals of neighbours
constexpr double kCosTurn = 0.819;      // 35 degrees that a collapse may turn a triangle
constexpr double kCosFlat = 0.966;      // 15 degrees between the normals of two triangles whose side is swapped
constexpr double kCosStraight = 0.906;  // 25 degrees that a sharp line may bend at a node that is removed
constexpr double kNeedle = 0.12;        // height over longest side
constexpr double kLongest = 1.45, kShortest = 0.9;  // of the wanted side; these give as many triangles as equal ones

Vector normal_of(const Vector& a, const Vector& b, const Vector& c) { return (b - a).cross(c - a); }

// Height over longest side: 0.87 for equal sides.
double quality(const Vector& a, const Vector& b, const Vector& c) {
  const double longest = std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
  return normal_of(a, b, c).norm() / longest;
}

class Tiling {
 public:
  Tiling(const mesh::TriangleMesh& surface, const std::vector<double>& sides, int mirrors)
      : mirrors_(mirrors), wanted_(sides) {
    for (Eigen::Index n = 0; n < surface.nodes.rows(); ++n) at_.push_back(surface.nodes.row(n).transpose());
    around_.resize(at_.size());
    sharp_.resize(at_.size());
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      add({surface.triangles(t, 0), surface.triangles(t, 1), surface.triangles(t, 2)});
    }
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) find_sharp_sides(t);
  }

  void split_long_sides() {
    struct Item {
      double length;
      int a, b;
      bool operator<(const Item& other) const { return length < other.length; }
    };
    std::priority_queue<Item> queue;
    const auto push = [&](int a, int b) {
      const double length = (at_[a] - at_[b]).norm();
      if (length > kLongest * wanted(a, b)) queue.push({length, std::min(a, b), std::max(a, b)});
    };
    for_sides(push);
    while (!queue.empty()) {
      const Item item = queue.top();
      queue.pop();
      if (!is_whole(item.a, item.b)) continue;
      const int middle = split(item.a, item.b);
      for (const int n : neighbours(middle)) push(middle, n);
    }
  }

  void collapse_short_sides() {
    struct Item {
      double length;
      int a, b;
      bool operator<(const Item& other) const { return length > other.length; }
    };
    std::priority_queue<Item> queue;
    const auto push = [&](int a, int b) {
      const double length = (at_[a] - at_[b]).norm();
      if (length < kShortest * wanted(a, b)) queue.push({length, std::min(a, b), std::max(a, b)});
    };
    for_sides(push);
    while (!queue.empty()) {
      const Item item = queue.top();
      queue.pop();
      if (!is_whole(item.a, item.b)) continue;
      int kept = -1;
      if (collapse(item.a, item.b)) {
        kept = item.b;
      } else if (collapse(item.b, item.a)) {
        kept = item.a;
      }
      if (kept < 0) continue;
      for (const int n : neighbours(kept)) push(kept, n);
    }
  }

  void swap_sides() {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        if (triangles_[t][0] < 0) break;
        const int a = triangles_[t][i], b = triangles_[t][(i + 1) % 3];
        if (a < b) swap(a, b);
      }
    }
  }

  [[nodiscard]] mesh::TriangleMesh result() const {
    mesh::TriangleMesh mesh;
    mesh.nodes.resize(static_cast<Eigen::Index>(at_.size()), 3);
    for (std::size_t n = 0; n < at_.size(); ++n) mesh.nodes.row(static_cast<Eigen::Index>(n)) = at_[n].transpose();
    const auto alive = std::count_if(triangles_.begin(), triangles_.end(), [](const Triangle& t) { return t[0] >= 0; });
    mesh.triangles.resize(alive, 3);
    Eigen::Index row = 0;
    for (const Triangle& t : triangles_) {
      if (t[0] >= 0) mesh.triangles.row(row++) << t[0], t[1], t[2];
    }
    return mesh;
  }

 private:
  // Calls visit(a, b) once for each side.
  void for_sides(const auto& visit) const {
    for (const Triangle& t : triangles_) {
      if (t[0] < 0) continue;
      for (int i = 0; i < 3; ++i) {
        if (t[i] < t[(i + 1) % 3] || on_plane(t[i], t[(i + 1) % 3])) visit(t[i], t[(i + 1) % 3]);
      }
    }
  }

  [[nodiscard]] double wanted(int a, int b) const { return (wanted_[a] + wanted_[b]) / 2; }
  int add(const Triangle& corners) {
    const int number = static_cast<int>(triangles_.size());
    triangles_.push_back(corners);
    for (const int n : corners) around_[n].push_back(number);
    return number;
  }
  void remove(int triangle) {
    for (const int n : triangles_[triangle]) std::erase(around_[n], triangle);
    triangles_[triangle] = {-1, -1, -1};
  }
  [[nodiscard]] Vector normal(int t) const {
    return normal_of(at_[triangles_[t][0]], at_[triangles_[t][1]], at_[triangles_[t][2]]).normalized();
  }
  [[nodiscard]] bool has(int triangle, int node) const {
    const Triangle& t = triangles_[triangle];
    return t[0] == node || t[1] == node || t[2] == node;
  }
  [[nodiscard]] std::vector<int> triangles_at(int a, int b) const {
    std::vector<int> found;
    for (const int t : around_[a]) {
      if (has(t, b)) found.push_back(t);
    }
    return found;
  }
  [[nodiscard]] int third(int triangle, int a, int b) const {
    for (const int n : triangles_[triangle]) {
      if (n != a && n != b) return n;
    }
    return -1;
  }
  [[nodiscard]] std::vector<int> neighbours(int node) const {
    std::vector<int> found;
    for (const int t : around_[node]) {
      for (const int n : triangles_[t]) {
        if (n != node && std::find(found.begin(), found.end(), n) == found.end()) found.push_back(n);
      }
    }
    return found;
  }
  // Returns true if the triangle has the side from a to b in this direction.
  [[nodiscard]] bool runs(int triangle, int a, int b) const {
    const Triangle& t = triangles_[triangle];
    return (t[0] == a && t[1] == b) || (t[1] == a && t[2] == b) || (t[2] == a && t[0] == b);
  }
  // planes(): the mirror planes on which a node lies, as bits. on_plane(): whether a side lies on one.
  [[nodiscard]] int planes(int node) const { return mirror_planes_at(at_[node], mirrors_); }
  [[nodiscard]] bool on_plane(int a, int b) const { return (planes(a) & planes(b)) != 0; }
  [[nodiscard]] bool is_whole(int a, int b) const { return triangles_at(a, b).size() == (on_plane(a, b) ? 1U : 2U); }
  [[nodiscard]] bool is_sharp(int a, int b) const {
    return std::find(sharp_[a].begin(), sharp_[a].end(), b) != sharp_[a].end();
  }
  void find_sharp_sides(int triangle) {
    for (int i = 0; i < 3; ++i) {
      const int a = triangles_[triangle][i], b = triangles_[triangle][(i + 1) % 3];
      if (a > b && !on_plane(a, b)) continue;
      const std::vector<int> both = triangles_at(a, b);
      if (both.size() == 2 && normal(both[0]).dot(normal(both[1])) > kCosSharp) continue;
      sharp_[a].push_back(b);
      sharp_[b].push_back(a);
    }
  }

  int split(int a, int b) {
    const int middle = static_cast<int>(at_.size());
    at_.push_back((at_[a] + at_[b]) / 2);
    wanted_.push_back(wanted(a, b));
    around_.emplace_back();
    sharp_.emplace_back();
    for (const int t : triangles_at(a, b)) {
      const int from = runs(t, a, b) ? a : b, to = from == a ? b : a, other = third(t, a, b);
      remove(t);
      add({from, middle, other});
      add({middle, to, other});
    }
    if (is_sharp(a, b)) {
      std::replace(sharp_[a].begin(), sharp_[a].end(), b, middle);
      std::replace(sharp_[b].begin(), sharp_[b].end(), a, middle);
      sharp_[middle] = {a, b};
    }
    return middle;
  }

  // Returns true if the sharp lines through `gone` allow it to be collapsed onto `kept`.
  [[nodiscard]] bool keeps_sharp_lines(int gone, int kept) const {
    const std::vector<int>& lines = sharp_[gone];
    if (lines.empty()) return true;
    if (lines.size() != 2 || !is_sharp(gone, kept)) return false;
    const int other = lines[0] == kept ? lines[1] : lines[0];
    if (is_sharp(other, kept)) return false;
    return (at_[gone] - at_[kept]).normalized().dot((at_[other] - at_[gone]).normalized()) > kCosStraight;
  }

  bool collapse(int gone, int kept) {
    if (!keeps_sharp_lines(gone, kept) || (planes(gone) & ~planes(kept)) != 0) return false;
    const std::vector<int> from = neighbours(gone), to = neighbours(kept);
    const auto common =
        std::count_if(from.begin(), from.end(), [&](int n) { return std::find(to.begin(), to.end(), n) != to.end(); });
    if (common != (on_plane(gone, kept) ? 1 : 2)) return false;
    for (const int n : from) {
      if (n != kept && (at_[n] - at_[kept]).norm() > kLongest * wanted(n, kept)) return false;
      const bool fresh = n != kept && std::find(to.begin(), to.end(), n) == to.end();
      if (fresh && (planes(n) & planes(kept) & ~planes(gone)) != 0) return false;  // makes an inner side on a plane
    }
    for (const int t : around_[gone]) {
      if (has(t, kept)) continue;
      Triangle moved = triangles_[t];
      std::replace(moved.begin(), moved.end(), gone, kept);
      const Vector &a = at_[moved[0]], &b = at_[moved[1]], &c = at_[moved[2]];
      if (normal_of(a, b, c).normalized().dot(normal(t)) < kCosTurn) return false;
      const double now = quality(a, b, c);
      const Triangle& old = triangles_[t];
      if (now < kNeedle && now < quality(at_[old[0]], at_[old[1]], at_[old[2]])) return false;
    }
    const std::vector<int> touched = around_[gone];
    for (const int t : touched) {
      if (has(t, kept)) {
        remove(t);
        continue;
      }
      std::erase(around_[gone], t);
      std::replace(triangles_[t].begin(), triangles_[t].end(), gone, kept);
      around_[kept].push_back(t);
    }
    move_sharp_lines(gone, kept);
    return true;
  }

  void move_sharp_lines(int gone, int kept) {
    for (const int n : sharp_[gone]) {
      if (n == kept) continue;
      std::replace(sharp_[n].begin(), sharp_[n].end(), gone, kept);
      sharp_[kept].push_back(n);
    }
    std::erase(sharp_[kept], gone);
    sharp_[gone].clear();
  }

  void swap(int a, int b) {
    const std::vector<int> both = triangles_at(a, b);
    if (both.size() != 2 || is_sharp(a, b)) return;
    const int left = runs(both[0], a, b) ? both[0] : both[1], right = left == both[0] ? both[1] : both[0];
    const int c = third(left, a, b), d = third(right, a, b);
    if (c == d || !triangles_at(c, d).empty() || on_plane(c, d)) return;
    const Vector before = normal(left), other = normal(right);
    if (before.dot(other) < kCosFlat) return;
    const double now = std::min(quality(at_[a], at_[b], at_[c]), quality(at_[b], at_[a], at_[d]));
    const double then = std::min(quality(at_[a], at_[d], at_[c]), quality(at_[d], at_[b], at_[c]));
    if (then < 1.05 * now) return;
    const Vector first = normal_of(at_[a], at_[d], at_[c]).normalized(),
                 second = normal_of(at_[d], at_[b], at_[c]).normalized();
    if (std::min({first.dot(before), first.dot(other), second.dot(before), second.dot(other)}) < kCosFlat) return;
    remove(left);
    remove(right);
    add({a, d, c});
    add({d, b, c});
  }

  const int mirrors_;
  std::vector<Vector> at_;
  std::vector<double> wanted_;            // the side around each node
  std::vector<Triangle> triangles_;       // removed triangles have corners -1
  std::vector<std::vector<int>> around_;  // the triangles at each node
  std::vector<std::vector<int>> sharp_;   // the nodes at the other ends of sharp sides
};

}  // namespace

mesh::TriangleMesh retile(const mesh::TriangleMesh& surface, double side_m, int mirrors) {
  return retile(surface, std::vector<double>(static_cast<std::size_t>(surface.nodes.rows()), side_m), mirrors);
}

mesh::TriangleMesh retile(const mesh::TriangleMesh& surface, const std::vector<double>& sides_m, int mirrors) {
  constexpr int kRounds = 3;
  Tiling tiling(surface, sides_m, mirrors);
  for (int round = 0; round < kRounds; ++round) {
    tiling.split_long_sides();
    tiling.collapse_short_sides();
    tiling.swap_sides();
  }
  return tiling.result();
}

}  // namespace ringdown::radiate
