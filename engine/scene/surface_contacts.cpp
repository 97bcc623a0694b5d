#include "engine/scene/surface_contacts.h"

#include <cmath>
#include <span>

// Corners of each body are compared with the triangles of the other, and edges with edges. For each kind, the trees of
// both bodies are descended together as long as their boxes are near each other. Trees of corners and of edges have
// small boxes also where triangles are long, as on the flat side of a hull.
//
// A corner touches a triangle if it lies over it, and if none of the corner's edges leads into the triangle's plane.
// Two edges touch if their common perpendicular ends on both, and if it lies between the normals of the two triangles
// beside each edge: a plane across it then separates the neighbourhoods of the two edges. (In terms of Gauss maps, the
// arcs of the two edges cross; see D. Gregorius, "The separating axis test between convex polyhedra", 2013.)
namespace ringdown::scene {
namespace {

// Sine of the angle by which a feature may miss its condition. Faces that lie on each other meet the condition only up
// to rounding.
constexpr double kSlack = 0.02;

// Sine of the least angle between two edges that touch in a point.
constexpr double kMinCrossing = 0.02;

// A corner this far outside of a triangle still counts as over it, so that no corner is lost between two triangles.
constexpr double kRounding_m = 1e-9;

Vec3 carry(const RelativePose& pose, Vec3 point) { return pose.position + pose.rotation * point; }

// Compares boxes of one body, carried into the other's frame, with boxes of the other.
class Nearness {
 public:
  Nearness(const RelativePose& pose, double margin_m) : pose_(pose), margin_m_(margin_m) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        back_[column][row] = pose.rotation[row][column];
        size_[row][column] = back_size_[column][row] = std::abs(pose.rotation[row][column]);
      }
    }
  }

  // Returns false only if a plane along a face of one of the boxes, with the margin beside it, parts them.
  [[nodiscard]] bool operator()(const BoxNode& one, const BoxNode& two) const {
    const Vec3 half = 0.5 * (one.high - one.low), other = 0.5 * (two.high - two.low);
    const Vec3 way = carry(pose_, 0.5 * (one.low + one.high)) - 0.5 * (two.low + two.high);
    return within(way, other, size_ * half) && within(back_ * way, half, back_size_ * other);
  }

 private:
  [[nodiscard]] bool within(Vec3 way, Vec3 half, Vec3 other) const {
    return std::abs(way.x) <= half.x + margin_m_ + other.x && std::abs(way.y) <= half.y + margin_m_ + other.y &&
           std::abs(way.z) <= half.z + margin_m_ + other.z;
  }

  const RelativePose& pose_;
  const double margin_m_;
  Matrix3 back_, size_, back_size_;  // the pose's rotation: inverse, magnitudes, and magnitudes of the inverse
};

double size(const BoxNode& node) {
  const Vec3 way = node.high - node.low;
  return dot(way, way);
}

// Calls `compare` for all pairs of leaves whose boxes are near each other.
template <class One, class Two, class Compare>
void descend(const BoxTree<One>& one, const BoxTree<Two>& two, const Nearness& near, const Compare& compare,
             std::uint32_t a = 0, std::uint32_t b = 0) {
  if (one.nodes.empty() || two.nodes.empty()) return;
  const BoxNode &of_one = one.nodes[a], &of_two = two.nodes[b];
  if (!near(of_one, of_two)) return;
  if (of_one.count > 0 && of_two.count > 0) {
    compare(std::span(one.items).subspan(of_one.first, of_one.count),
            std::span(two.items).subspan(of_two.first, of_two.count));
  } else if (of_two.count > 0 || (of_one.count == 0 && size(of_one) > size(of_two))) {
    descend(one, two, near, compare, of_one.left, b);
    descend(one, two, near, compare, of_one.right, b);
  } else {
    descend(one, two, near, compare, a, of_two.left);
    descend(one, two, near, compare, a, of_two.right);
  }
}

class Search {
 public:
  Search(double margin_m, const DepthLimit& limit, std::vector<SurfaceContact>& found)
      : margin_m_(margin_m), limit_(limit), found_(found) {}

  // Corners of one body over triangles of the other, in whose frame the contacts are, with normals out of the other.
  void find_corners(const BoxTree<SurfaceCorner>& corners, const BoxTree<SurfaceTriangle>& triangles,
                    const RelativePose& pose) {
    const auto compare = [&](std::span<const SurfaceCorner> some, std::span<const SurfaceTriangle> others) {
      for (const SurfaceCorner& corner : some) {
        const Vec3 point = carry(pose, corner.point);
        for (const SurfaceTriangle& triangle : others) touch(point, corner, pose.rotation, triangle);
      }
    };
    descend(corners, triangles, Nearness(pose, margin_m_), compare);
  }

  void find_edges(const BoxTree<SurfaceEdge>& one, const BoxTree<SurfaceEdge>& two, const RelativePose& pose) {
    const auto compare = [&](std::span<const SurfaceEdge> some, std::span<const SurfaceEdge> others) {
      for (const SurfaceEdge& edge : some) {
        const SurfaceEdge carried{carry(pose, edge.from), carry(pose, edge.to), pose.rotation * edge.normal,
                                  pose.rotation * edge.other_normal};
        for (const SurfaceEdge& other : others) touch(carried, other);
      }
    };
    descend(one, two, Nearness(pose, margin_m_), compare);
  }

 private:
  void touch(Vec3 point, const SurfaceCorner& corner, const Matrix3& turn, const SurfaceTriangle& triangle) {
    const double distance_m = dot(point - triangle.corners[0], triangle.normal);
    if (distance_m > margin_m_ || distance_m < -limit_.max_m) return;
    for (int k = 0; k < 3; ++k) {
      if (dot(point - triangle.corners[k], triangle.inwards[k]) < -kRounding_m) return;
    }
    for (const Vec3& way : corner.around) {
      if (dot(turn * way, triangle.normal) < -kSlack) return;
    }
    add(point - distance_m * triangle.normal, triangle.normal, -distance_m);
  }

  void touch(const SurfaceEdge& one, const SurfaceEdge& two) {
    const Vec3 d = one.to - one.from, e = two.to - two.from, apart = two.from - one.from;
    const Vec3 across = cross(d, e);
    const double size2 = dot(across, across);
    const double off = dot(apart, across);
    if (off * off > size2 * limit_.max_m * limit_.max_m && off * off > size2 * margin_m_ * margin_m_) return;
    if (size2 < kMinCrossing * kMinCrossing * dot(d, d) * dot(e, e)) return;
    const double s = dot(cross(apart, e), across) / size2, t = dot(cross(apart, d), across) / size2;
    if (s < 0 || s > 1 || t < 0 || t > 1) return;
    Vec3 normal = (1 / std::sqrt(size2)) * across;
    if (dot(normal, two.normal + two.other_normal) < 0) normal = -1 * normal;
    const Vec3 on_two = two.from + t * e;
    const double distance_m = dot(one.from + s * d - on_two, normal);
    if (distance_m > margin_m_ || distance_m < -limit_.max_m) return;
    if (between(normal, two) && between(-1 * normal, one)) add(on_two, normal, -distance_m);
  }

  // Returns whether a direction across the edge lies between the normals beside the edge.
  static bool between(Vec3 way, const SurfaceEdge& edge) {
    const Vec3 turn = cross(edge.normal, edge.other_normal);
    const double min = -kSlack * length(turn);
    return dot(cross(edge.normal, way), turn) >= min && dot(cross(way, edge.other_normal), turn) >= min;
  }

  void add(Vec3 point, Vec3 normal, double depth_m) {
    if (depth_m > limit_.standing_m && depth_m > limit_.standing_m + limit_.came_in_m(point, normal)) return;
    found_.push_back({point, normal, depth_m});
  }

  double margin_m_;
  const DepthLimit& limit_;
  std::vector<SurfaceContact>& found_;
};

}  // namespace

void find_surface_contacts(const Surface& first, const Surface& second, const RelativePose& pose, double margin_m,
                           const DepthLimit& limit, std::vector<SurfaceContact>& found) {
  const Matrix3 back = transpose(pose.rotation);
  const RelativePose other_way{back, -1 * (back * pose.position)};
  const auto in_second = [&](SurfaceContact contact) {
    return SurfaceContact{carry(pose, contact.point), -1 * (pose.rotation * contact.normal), contact.depth_m};
  };
  std::vector<SurfaceContact> in_first;
  const DepthLimit limit_in_first{limit.standing_m, limit.max_m, [&](Vec3 point, Vec3 normal) {
                                    const SurfaceContact there = in_second({point, normal});
                                    return limit.came_in_m(there.point, there.normal);
                                  }};
  Search(margin_m, limit_in_first, in_first).find_corners(second.corners, first.triangles, other_way);
  for (const SurfaceContact& contact : in_first) found.push_back(in_second(contact));
  Search search(margin_m, limit, found);
  search.find_corners(first.corners, second.triangles, pose);
  search.find_edges(first.edges, second.edges, pose);
}

}  // namespace ringdown::scene
