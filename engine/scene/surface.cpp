#include "engine/scene/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace ringdown::scene {
namespace {

constexpr std::uint32_t kLeaf = 3;  // items

// Sine of the angle between two triangles below which their common edge counts as flat.
constexpr double kFlat = 5e-3;

Vec3 unit(Vec3 v) { return (1 / length(v)) * v; }

double part(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

void enclose(BoxNode& node, Vec3 point) {
  node.low = {std::min(node.low.x, point.x), std::min(node.low.y, point.y), std::min(node.low.z, point.z)};
  node.high = {std::max(node.high.x, point.x), std::max(node.high.y, point.y), std::max(node.high.z, point.z)};
}

void enclose(BoxNode& node, const SurfaceTriangle& triangle) {
  for (const Vec3& corner : triangle.corners) enclose(node, corner);
}

void enclose(BoxNode& node, const SurfaceEdge& edge) {
  enclose(node, edge.from);
  enclose(node, edge.to);
}

void enclose(BoxNode& node, const SurfaceCorner& corner) { enclose(node, corner.point); }

Vec3 middle(const SurfaceTriangle& triangle) {
  return (1.0 / 3) * (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]);
}
Vec3 middle(const SurfaceEdge& edge) { return 0.5 * (edge.from + edge.to); }
Vec3 middle(const SurfaceCorner& corner) { return corner.point; }

// Makes the node of the items from `begin` to `end`, with all nodes below, and returns its number. A node is split at
// the median of its longest side.
template <class Item>
std::uint32_t make_node(BoxTree<Item>& tree, std::uint32_t begin, std::uint32_t end) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  BoxNode node{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}, begin, end - begin};
  for (std::uint32_t k = begin; k < end; ++k) enclose(node, tree.items[k]);
  const auto number = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes.push_back(node);
  if (end - begin <= kLeaf) return number;
  const Vec3 size = node.high - node.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t k) { return tree.items.begin() + k; };
  std::nth_element(at(begin), at(half), at(end),
                   [axis](const Item& a, const Item& b) { return part(middle(a), axis) < part(middle(b), axis); });
  const std::uint32_t left = make_node(tree, begin, half), right = make_node(tree, half, end);
  tree.nodes[number].left = left;
  tree.nodes[number].right = right;
  tree.nodes[number].count = 0;
  return number;
}

template <class Item>
void make_tree(BoxTree<Item>& tree) {
  if (!tree.items.empty()) make_node(tree, 0, static_cast<std::uint32_t>(tree.items.size()));
}

}  // namespace

Surface make_surface(std::span<const Vec3> points, std::span<const std::array<std::uint32_t, 3>> triangles) {
  Surface surface;
  struct Beside {
    Vec3 normal;
    std::uint32_t opposite;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Beside>> edges;
  double volume = 0, area = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 twice = cross(points[b] - points[a], points[c] - points[a]);
    if (!(length(twice) > 0)) continue;
    volume += dot(points[a], cross(points[b], points[c])) / 6;
    area += 0.5 * length(twice);
    const auto inwards = [&](std::uint32_t from, std::uint32_t to) {
      return unit(cross(twice, points[to] - points[from]));
    };
    surface.triangles.items.push_back(
        {{points[a], points[b], points[c]}, unit(twice), {inwards(a, b), inwards(b, c), inwards(c, a)}});
    for (const auto& [from, to, opposite] : {std::array{a, b, c}, std::array{b, c, a}, std::array{c, a, b}}) {
      edges[std::minmax(from, to)].push_back({unit(twice), opposite});
      surface.reach_m = std::max(surface.reach_m, length(points[from]));
    }
  }
  if (area > 0) surface.thickness_m = 2 * std::abs(volume) / area;
  std::map<std::uint32_t, std::vector<Vec3>> around;
  std::set<std::uint32_t> ends;  // of edges about which the surface is convex: no other corner sticks out
  for (const auto& [edge, beside] : edges) {
    const auto [from, to] = edge;
    if (points[from] == points[to]) continue;
    around[from].push_back(unit(points[to] - points[from]));
    around[to].push_back(unit(points[from] - points[to]));
    if (beside.size() != 2) continue;
    const Vec3 normal = beside[0].normal, other = beside[1].normal;
    const bool convex = dot(normal, points[beside[1].opposite] - points[from]) < 0;
    if (!convex || (length(cross(normal, other)) <= kFlat && dot(normal, other) > 0)) continue;
    surface.edges.items.push_back({points[from], points[to], normal, other});
    ends.insert({from, to});
  }
  for (const std::uint32_t corner : ends) {
    surface.corners.items.push_back({points[corner], std::move(around.at(corner))});
  }
  make_tree(surface.triangles);
  make_tree(surface.edges);
  make_tree(surface.corners);
  return surface;
}

Surface box_surface(Vec3 size) {
  std::vector<Vec3> points;
  for (int corner = 0; corner < 8; ++corner) {
    points.push_back(
        {(corner & 1 ? 0.5 : -0.5) * size.x, (corner & 2 ? 0.5 : -0.5) * size.y, (corner & 4 ? 0.5 : -0.5) * size.z});
  }
  constexpr std::array<std::array<std::uint32_t, 3>, 12> kTriangles{{{0, 2, 1},
                                                                     {1, 2, 3},
                                                                     {4, 5, 6},
                                                                     {5, 7, 6},
                                                                     {0, 1, 4},
                                                                     {1, 5, 4},
                                                                     {2, 6, 3},
                                                                     {3, 6, 7},
                                                                     {0, 4, 2},
                                                                     {2, 4, 6},
                                                                     {1, 3, 5},
                                                                     {3, 7, 5}}};
  return make_surface(points, kTriangles);
}

}  // namespace ringdown::scene
