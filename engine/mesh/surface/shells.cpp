#include "engine/mesh/surface/shells.h"

#include "engine/base/groups.h"
#include "engine/mesh/stuffing/winding_number.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

// Finding shells
//
// Triangles are linked through edges that exactly two triangles have; linked triangles form a part. At an edge with
// more triangles, each part that has two triangles there is linked to itself, so bodies that touch along an edge stay
// apart, even if one is inside out. If parts have other numbers of triangles there, and equally many triangles run
// forward and backward along the edge, the triangles are sorted by angle. Going round the edge, a body begins at a
// backward triangle and ends at a forward one, like brackets; matching triangles are linked. From each triangle without
// a shell, a breadth-first search collects all linked triangles: one shell. Each step checks whether the next triangle
// is wound like its neighbour, so every triangle is marked as turned or not relative to the first; if the turned
// triangles have more than half of the area, the marks are exchanged. The volume is the sum of the tetrahedra between
// the triangles and one point.
//
// Shell A lies inside shell B if A's box lies in B's, and B's winding number is 1 at points spread over A, each
// slightly inside A. A shell that pokes out, or that the other's surface cuts in two, does not lie inside.
namespace ringdown::mesh {
namespace {

using Node = Eigen::RowVector3d;

class Grower {
 public:
  Grower(const TriangleMesh& mesh, const std::vector<bool>& usable)
      : mesh_(mesh), edges_(edges_of(mesh, usable)), part_(usable.size()) {
    const auto count = static_cast<std::size_t>(mesh.triangles.rows());
    shells_.shell.assign(count, -1);
    shells_.turned.assign(count, false);
    free_.assign(count, false);
    link(count);
    for (std::size_t t = 0; t < count; ++t) {
      if (usable[t] && shells_.shell[t] < 0) grow(static_cast<std::int32_t>(t));
    }
    mark_open();
  }

  Shells take() { return std::move(shells_); }

 private:
  struct Link {
    std::int32_t triangle;
    bool agrees;  // the two triangles run through the edge in opposite directions
  };

  void link(std::size_t count) {
    links_.resize(count);
    for (std::size_t first = 0, last; first < edges_.size(); first = last) {
      last = end_of_edge(edges_, first);
      if (last - first == 2) join(edges_[first], edges_[first + 1]);
    }
    for (std::size_t first = 0, last; first < edges_.size(); first = last) {
      last = end_of_edge(edges_, first);
      if (last - first == 2 || link_parts(first, last) || link_crowded(first, last)) continue;
      for (std::size_t e = first; e < last; ++e) free_[static_cast<std::size_t>(edges_[e].triangle)] = true;
    }
  }

  void join(const EdgeUse& a, const EdgeUse& b) {
    const bool agrees = a.forward != b.forward;
    links_[static_cast<std::size_t>(a.triangle)].push_back({b.triangle, agrees});
    links_[static_cast<std::size_t>(b.triangle)].push_back({a.triangle, agrees});
    part_.join_to(static_cast<std::size_t>(a.triangle), static_cast<std::size_t>(b.triangle));
  }

  // Returns the present part of the use's triangle, as the number of the part's first triangle.
  std::size_t part_of(const EdgeUse& use) { return part_.root(static_cast<std::size_t>(use.triangle)); }

  // Links the two triangles of each part at this edge, however the parts are wound. Returns false if some part does not
  // have exactly two there, one in either direction.
  bool link_parts(std::size_t first, std::size_t last) {
    std::vector<std::pair<std::size_t, std::size_t>> uses;  // part and use
    for (std::size_t e = first; e < last; ++e) uses.emplace_back(part_of(edges_[e]), e);
    if (uses.size() % 2 != 0) return false;
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size(); i += 2) {
      const bool last_of_part = i + 2 == uses.size() || uses[i + 2].first != uses[i].first;
      const bool opposed = edges_[uses[i].second].forward != edges_[uses[i + 1].second].forward;
      if (uses[i].first != uses[i + 1].first || !last_of_part || !opposed) return false;
    }
    for (std::size_t i = 0; i < uses.size(); i += 2) join(edges_[uses[i].second], edges_[uses[i + 1].second]);
    return true;
  }

  // Links triangles by angle. Returns false if the numbers of forward and backward triangles differ. Angles grow
  // counter-clockwise as seen against the edge's direction, so the inside of a body lies at greater angles than its
  // backward triangle, up to its forward one.
  bool link_crowded(std::size_t first, std::size_t last) {
    struct Side {
      double angle;
      bool opens;
      std::size_t use;
    };
    const Node from = mesh_.nodes.row(edges_[first].low);
    const Node along = (Node(mesh_.nodes.row(edges_[first].high)) - from).normalized();
    const auto backward = std::count_if(edges_.begin() + static_cast<std::ptrdiff_t>(first),
                                        edges_.begin() + static_cast<std::ptrdiff_t>(last),
                                        [](const EdgeUse& use) { return !use.forward; });
    if (last == first + 1 || 2 * static_cast<std::size_t>(backward) != last - first) return false;
    std::vector<Side> sides;
    Node u = Node::Zero(), v = Node::Zero();
    for (std::size_t e = first; e < last; ++e) {
      const auto row = mesh_.triangles.row(edges_[e].triangle);
      const std::int32_t apex = row.sum() - edges_[e].low - edges_[e].high;
      Node away = Node(mesh_.nodes.row(apex)) - from;
      away -= away.dot(along) * along;
      if (e == first) {
        u = away.normalized();
        v = along.cross(u);
      }
      constexpr double kStep = 1e-9;  // triangles in one plane have the same angle
      double angle = kStep * std::round(std::atan2(away.dot(v), away.dot(u)) / kStep);
      if (angle < 0) angle += 2 * std::numbers::pi;
      sides.push_back({angle, !edges_[e].forward, e});
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      if (a.angle != b.angle) return a.angle < b.angle;
      return a.opens != b.opens ? !a.opens : a.use < b.use;  // one body ends before the next begins
    });
    // The round begins at the angle with the fewest open bodies.
    std::size_t start = 0;
    int open = 0, fewest = 0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      open += sides[i].opens ? 1 : -1;
      if (open < fewest) {
        fewest = open;
        start = i + 1;
      }
    }
    std::vector<std::size_t> waiting;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const Side& side = sides[(start + i) % sides.size()];
      if (side.opens) {
        waiting.push_back(side.use);
      } else {
        join(edges_[waiting.back()], edges_[side.use]);
        waiting.pop_back();
      }
    }
    return true;
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
    for (std::size_t t = 0; t < free_.size(); ++t) {
      if (free_[t] && shells_.shell[t] >= 0) shells_.closed[static_cast<std::size_t>(shells_.shell[t])] = false;
    }
  }

  const TriangleMesh& mesh_;
  std::vector<EdgeUse> edges_;
  std::vector<std::vector<Link>> links_;
  Groups<> part_;           // of triangles
  std::vector<bool> free_;  // triangles with an edge through which they have no neighbour
  Shells shells_;
};

// Finds which shells lie inside which, and the role that follows for each.
class Nesting {
 public:
  Nesting(const TriangleMesh& mesh, Shells& shells, CavityRule rule) : mesh_(mesh), shells_(shells), rule_(rule) {
    const auto count = static_cast<std::size_t>(shells.count);
    shells_.depth.assign(count, 0);
    shells_.parent.assign(count, -1);
    shells_.role.assign(count, Role::kBody);
  }

  void run() {
    if (shells_.count < 2 || static_cast<std::size_t>(shells_.count) > kMaxShells) return;
    collect();
    find_around();
    give_roles();
  }

 private:
  struct Box {
    Node low = Node::Constant(std::numeric_limits<double>::infinity()), high = -low;
  };

  [[nodiscard]] Node corner(std::int32_t t, int i) const { return mesh_.nodes.row(mesh_.triangles(t, i)); }

  void collect() {
    members_.resize(static_cast<std::size_t>(shells_.count));
    boxes_.resize(members_.size());
    for (std::size_t t = 0; t < shells_.shell.size(); ++t) {
      if (shells_.shell[t] < 0) continue;
      const auto s = static_cast<std::size_t>(shells_.shell[t]);
      members_[s].push_back(static_cast<std::int32_t>(t));
      for (int i = 0; i < 3; ++i) {
        boxes_[s].low = boxes_[s].low.cwiseMin(corner(members_[s].back(), i));
        boxes_[s].high = boxes_[s].high.cwiseMax(corner(members_[s].back(), i));
      }
    }
  }

  [[nodiscard]] bool boxed(std::size_t inner, std::size_t outer) const {
    const Box &in = boxes_[inner], &out = boxes_[outer];
    const double hair = 1e-9 * (out.high - out.low).norm();
    return (in.low.array() >= out.low.array() - hair).all() && (in.high.array() <= out.high.array() + hair).all();
  }

  void find_around() {
    around_.resize(members_.size());
    for (std::size_t outer = 0; outer < members_.size(); ++outer) {
      if (!shells_.closed[outer]) continue;
      std::vector<std::size_t> candidates;
      for (std::size_t inner = 0; inner < members_.size(); ++inner) {
        const bool smaller = std::abs(shells_.volume_m3[inner]) < std::abs(shells_.volume_m3[outer]);
        if (inner != outer && smaller && boxed(inner, outer)) candidates.push_back(inner);
      }
      if (candidates.empty()) continue;
      const WindingNumber winding(alone(outer));
      for (const std::size_t inner : candidates) {
        if (lies_in(inner, winding)) around_[inner].push_back(outer);
      }
    }
  }

  [[nodiscard]] TriangleMesh alone(std::size_t s) const {
    TriangleMesh shell{.nodes = mesh_.nodes, .triangles = Triangles(static_cast<Eigen::Index>(members_[s].size()), 3)};
    Eigen::Index row = 0;
    for (const std::int32_t t : members_[s]) {
      shell.triangles.row(row) = mesh_.triangles.row(t);
      if (shells_.turned[static_cast<std::size_t>(t)]) std::swap(shell.triangles(row, 1), shell.triangles(row, 2));
      ++row;
    }
    drop_unused_nodes(shell);
    return shell;
  }

  [[nodiscard]] bool lies_in(std::size_t inner, const WindingNumber& winding) const {
    constexpr std::size_t kMaxTriangles = 500;
    constexpr double kHair = 1e-6;  // share of a triangle's size
    constexpr std::array<std::array<double, 3>, 4> kSpots = {
        {{1 / 3.0, 1 / 3.0, 1 / 3.0}, {0.98, 0.01, 0.01}, {0.01, 0.98, 0.01}, {0.01, 0.01, 0.98}}};
    const std::size_t stride = (members_[inner].size() + kMaxTriangles - 1) / kMaxTriangles;
    for (std::size_t i = 0; i < members_[inner].size(); i += stride) {
      const std::int32_t t = members_[inner][i];
      const Node a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
      const Node normal = (b - a).cross(c - a);
      const bool inward = shells_.turned[static_cast<std::size_t>(t)] != (shells_.volume_m3[inner] < 0);
      const Node step = (inward ? kHair : -kHair) / std::sqrt(normal.norm()) * normal;
      for (const auto& [p, q, r] : kSpots) {
        if (winding.at((p * a + q * b + r * c + step).transpose(), 0.05) < 0.5) return false;
      }
    }
    return true;
  }

  // Goes from the outermost shells inward: a shell that lies in air is a body.
  void give_roles() {
    std::vector<std::size_t> order(around_.size());
    for (std::size_t s = 0; s < order.size(); ++s) shells_.depth[s] = static_cast<int>(around_[s].size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return shells_.depth[a] < shells_.depth[b]; });
    for (const std::size_t s : order) {
      if (around_[s].empty()) continue;
      const std::size_t parent =
          *std::max_element(around_[s].begin(), around_[s].end(),
                            [this](std::size_t a, std::size_t b) { return shells_.depth[a] < shells_.depth[b]; });
      shells_.parent[s] = static_cast<int>(parent);
      if (shells_.role[parent] == Role::kCavity) continue;
      const bool opposed = (shells_.volume_m3[s] < 0) != (shells_.volume_m3[parent] < 0);
      shells_.role[s] = opposed || rule_ == CavityRule::kInside ? Role::kCavity : Role::kBuried;
    }
  }

  const TriangleMesh& mesh_;
  Shells& shells_;
  CavityRule rule_;
  std::vector<std::vector<std::int32_t>> members_;
  std::vector<Box> boxes_;
  std::vector<std::vector<std::size_t>> around_;  // the closed shells that a shell lies in
};

}  // namespace

Shells shells_of(const TriangleMesh& mesh, CavityRule rule) {
  Shells shells = Grower(mesh, usable_triangles(mesh)).take();
  Nesting(mesh, shells, rule).run();
  return shells;
}

}  // namespace ringdown::mesh
