#include "engine/modal/surface_index.h"

#include "engine/base/triangle.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

// The tree is built by halving the triangles along the longest side of their box, twice for each node, until each has a
// box of its own. A search keeps a stack of boxes that may hold the nearest point, with their distances, and looks into
// the nearest first; a box further away than the best point so far is dropped. The stack is an array of fixed size, so
// the audio thread may search.
//
// Distances of boxes are computed in float, which is exact enough to choose an order, and a box is dropped only where
// its distance exceeds the best one by more than float can be wrong. Distances of triangles are computed in double.
namespace ringdown::modal {
namespace {

constexpr std::size_t kMaxTree = 48;      // 2^21 triangles have 11 levels, each of which leaves three boxes to look at
constexpr double kFloatError = 1e-6;      // of a box's distance, over the largest coordinate
constexpr double kSquareError = 1.00001;  // of its square

Vec3 lowest(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
Vec3 highest(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
double largest(Vec3 a) REALTIME { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

struct Box {
  Vec3 low, high;
};

template <class Triangles>
Box box_of(const Triangles& triangles, std::uint32_t begin, std::uint32_t end) {
  Box box{triangles[begin].corners[0], triangles[begin].corners[0]};
  for (std::uint32_t i = begin; i < end; ++i) {
    for (const Vec3& corner : triangles[i].corners) {
      box.low = lowest(box.low, corner);
      box.high = highest(box.high, corner);
    }
  }
  return box;
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
  const auto count = static_cast<std::uint32_t>(triangles_.size());
  const Box box = box_of(triangles_, 0, count);
  low_m_ = box.low;
  high_m_ = box.high;
  reach_m_ = std::max(largest(low_m_), largest(high_m_));
  nodes_.reserve(triangles_.size());
  build(0, count);
}

// Sorts the halves of a range of triangles to either side of the longest side's middle. Returns where the second
// begins.
std::uint32_t SurfaceIndex::halve(std::uint32_t begin, std::uint32_t end) {
  const Box box = box_of(triangles_, begin, end);
  const Vec3 size = box.high - box.low;
  const auto coordinate = size.x >= size.y && size.x >= size.z ? &Vec3::x : (size.y >= size.z ? &Vec3::y : &Vec3::z);
  const auto center = [coordinate](const Triangle& t) {
    return t.corners[0].*coordinate + t.corners[1].*coordinate + t.corners[2].*coordinate;
  };
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(triangles_.begin() + begin, triangles_.begin() + middle, triangles_.begin() + end,
                   [&center](const Triangle& a, const Triangle& b) { return center(a) < center(b); });
  return middle;
}

// Builds the tree of a range of triangles and returns its root.
std::uint32_t SurfaceIndex::build(std::uint32_t begin, std::uint32_t end) {
  struct Range {
    std::uint32_t begin, end;
    [[nodiscard]] std::uint32_t size() const { return end - begin; }
  };
  std::array<Range, Node::kChildren> ranges{Range{begin, end}};
  std::size_t count = 1;
  for (; count < Node::kChildren; ++count) {
    Range& widest = *std::max_element(ranges.begin(), ranges.begin() + count,
                                      [](const Range& a, const Range& b) { return a.size() < b.size(); });
    if (widest.size() == 1) break;
    const std::uint32_t middle = halve(widest.begin, widest.end);
    ranges[count] = {middle, widest.end};
    widest.end = middle;
  }
  const std::size_t place = nodes_.size();
  nodes_.emplace_back();
  for (std::size_t i = 0; i < count; ++i) {
    const Range& range = ranges[i];
    const Box box = box_of(triangles_, range.begin, range.end);
    const Vec3 middle = 0.5 * (box.low + box.high), half = 0.5 * (box.high - box.low);
    const std::uint32_t child = range.size() == 1 ? Node::kTriangle + range.begin : build(range.begin, range.end);
    Node& node = nodes_[place];
    constexpr std::array kAxes = {&Vec3::x, &Vec3::y, &Vec3::z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      node.middle[axis][i] = static_cast<float>(middle.*kAxes[axis]);
      node.half[axis][i] = static_cast<float>(half.*kAxes[axis]);
    }
    node.child[i] = child;
  }
  return static_cast<std::uint32_t>(place);
}

double SurfaceIndex::size_m() const { return length(high_m_ - low_m_); }

double SurfaceIndex::distance_m(Vec3 query) const { return length(query - highest(low_m_, lowest(query, high_m_))); }

// Written without a choice, so that the compiler makes vector instructions of it.
SurfaceIndex::Node::Four SurfaceIndex::Node::squared_distances(const std::array<float, 3>& query) const REALTIME {
  Four sum;
  for (std::size_t i = 0; i < kChildren; ++i) {
    const auto outside = [&](std::size_t axis) REALTIME {
      const float beyond = std::abs(query[axis] - middle[axis][i]) - half[axis][i];
      return 0.5f * (beyond + std::abs(beyond));  // 0 inside
    };
    const float x = outside(0), y = outside(1), z = outside(2);
    sum[i] = x * x + y * y + z * z;
  }
  return sum;
}

SurfacePoint SurfaceIndex::nearest(Vec3 query) const REALTIME {
  struct Pending {
    float squared;
    std::uint32_t child;
  };
  const Node* const nodes = nodes_.data();
  const Triangle* const triangles = triangles_.data();
  const std::array<float, 3> rounded = {static_cast<float>(query.x), static_cast<float>(query.y),
                                        static_cast<float>(query.z)};
  const double error = kFloatError * std::max(reach_m_, largest(query));
  std::array<Pending, kMaxTree> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0};
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  float max_squared = std::numeric_limits<float>::infinity();  // of boxes that may hold a better point
  while (depth > 0) {
    const Pending top = stack[--depth];
    if (top.squared > max_squared) continue;
    if (top.child >= Node::kTriangle) {
      const Triangle& triangle = triangles[top.child - Node::kTriangle];
      const auto weights = nearest_on_triangle(query, triangle.corners);
      const Vec3 offset = at_weights(triangle.corners, weights) - query;
      if (dot(offset, offset) >= best_squared) continue;
      best_squared = dot(offset, offset);
      best = {triangle.points, weights, std::sqrt(best_squared)};
      const double max = best.distance_m + error;
      max_squared = static_cast<float>(kSquareError * max * max);
      continue;
    }
    const Node& node = nodes[top.child];
    const Node::Four squared = node.squared_distances(rounded);
    const std::size_t first = depth;
    for (std::size_t i = 0; i < Node::kChildren && node.child[i] != Node::kNone; ++i) {
      if (squared[i] > max_squared) continue;
      std::size_t at = depth++;
      for (; at > first && stack[at - 1].squared < squared[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {squared[i], node.child[i]};
    }
  }
  return best;
}

}  // namespace ringdown::modal
