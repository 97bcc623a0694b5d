#include "engine/modal/surface_index.h"

#include "engine/base/triangle.h"

#include <algorithm>
#include <cassert>
#include <limits>

// The tree is built by halving the triangles along the longest side of their box, until few are left. A search keeps a
// stack of nodes that may hold the nearest point, with their distances, and descends into the nearer child first; a
// node further away than the best point so far is dropped. The stack is an array of fixed size, so the audio thread may
// search.
namespace ringdown::modal {
namespace {

constexpr std::uint32_t kLeafSize = 2;
constexpr std::size_t kMaxTree = 48;  // halving 2^20 points or 2 * 2^20 triangles needs 20 levels

Vec3 lowest(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 highest(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

double squared_distance_to_box(Vec3 p, Vec3 low, Vec3 high) REALTIME {
  const auto outside = [](double x, double min, double max)
                           REALTIME { return std::max(std::max(min - x, x - max), 0.0); };
  const double dx = outside(p.x, low.x, high.x), dy = outside(p.y, low.y, high.y), dz = outside(p.z, low.z, high.z);
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace

SurfaceIndex::SurfaceIndex(const Bank& bank) {
  const auto position = [&bank](std::uint32_t p) {
    const Vec3f& v = bank.positions[p];
    return Vec3{v[0], v[1], v[2]};
  };
  for (const auto& t : bank.triangles) triangles_.push_back({t, {position(t[0]), position(t[1]), position(t[2])}});
  if (bank.triangles.empty()) {
    for (std::uint32_t p = 0; p < bank.point_count(); ++p) {
      triangles_.push_back({{p, p, p}, {position(p), position(p), position(p)}});
    }
  }
  assert(!triangles_.empty());
  nodes_.reserve(2 * triangles_.size());
  build(0, static_cast<std::uint32_t>(triangles_.size()));
}

void SurfaceIndex::build(std::uint32_t begin, std::uint32_t end) {
  Node node{
      .low = triangles_[begin].corners[0], .high = triangles_[begin].corners[0], .first = begin, .count = end - begin};
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vec3& corner : triangles_[i].corners) {
      node.low = lowest(node.low, corner);
      node.high = highest(node.high, corner);
    }
  }
  const std::size_t place = nodes_.size();
  nodes_.push_back(node);
  if (node.count <= kLeafSize) return;

  const Vec3 size = node.high - node.low;
  const auto coordinate = size.x >= size.y && size.x >= size.z ? &Vec3::x : (size.y >= size.z ? &Vec3::y : &Vec3::z);
  const auto center = [coordinate](const Triangle& t) {
    return t.corners[0].*coordinate + t.corners[1].*coordinate + t.corners[2].*coordinate;
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                   [&center](const Triangle& a, const Triangle& b) { return center(a) < center(b); });
  build(begin, middle);
  nodes_[place].first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[place].count = 0;
  build(middle, end);
}

double SurfaceIndex::size_m() const { return length(nodes_.front().high - nodes_.front().low); }

double SurfaceIndex::distance_m(Vec3 query) const {
  return std::sqrt(squared_distance_to_box(query, nodes_.front().low, nodes_.front().high));
}

SurfacePoint SurfaceIndex::nearest(Vec3 query) const REALTIME {
  struct Pending {
    std::uint32_t node;
    double squared;
  };
  const Node* nodes = nodes_.data();
  const Triangle* triangles = triangles_.data();
  const auto pending = [nodes, query](std::uint32_t n) REALTIME {
    return Pending{n, squared_distance_to_box(query, nodes[n].low, nodes[n].high)};
  };
  std::array<Pending, kMaxTree> stack;
  std::size_t depth = 0;
  stack[depth++] = pending(0);
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  while (depth > 0) {
    const Pending top = stack[--depth];
    if (top.squared >= best_squared) continue;
    const Node& node = nodes[top.node];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto weights = nearest_on_triangle(query, triangles[i].corners);
      const Vec3 offset = at_weights(triangles[i].corners, weights) - query;
      if (dot(offset, offset) < best_squared) {
        best_squared = dot(offset, offset);
        best = {triangles[i].points, weights, 0};
      }
    }
    if (node.count > 0) continue;
    Pending nearer = pending(top.node + 1), farther = pending(node.first);
    if (farther.squared < nearer.squared) std::swap(nearer, farther);
    stack[depth++] = farther;
    stack[depth++] = nearer;
  }
  best.distance_m = std::sqrt(best_squared);
  return best;
}

}  // namespace ringdown::modal
