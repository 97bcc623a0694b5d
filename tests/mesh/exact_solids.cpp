#include "tests/mesh/exact_solids.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

namespace ringdown::test {
namespace {

ExactPoint minus(const ExactPoint& a, const ExactPoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
mpq_class dot(const ExactPoint& a, const ExactPoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
ExactPoint cross(const ExactPoint& a, const ExactPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

ExactPoint between(const ExactPoint& a, const ExactPoint& b, const mpq_class& at) {
  return {a[0] + at * (b[0] - a[0]), a[1] + at * (b[1] - a[1]), a[2] + at * (b[2] - a[2])};
}

}  // namespace

ConvexSolid::ConvexSolid(const std::vector<Eigen::RowVector3d>& points, const std::vector<std::vector<int>>& faces) {
  const auto exact = [&points](int corner) -> ExactPoint {
    const Eigen::RowVector3d& at = points[static_cast<std::size_t>(corner)];
    return {mpq_class(at[0]), mpq_class(at[1]), mpq_class(at[2])};
  };
  for (const std::vector<int>& face : faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      faces_.push_back({exact(face[0]), exact(face[i]), exact(face[i + 1])});
    }
  }
}

// Cuts away what lies in front of a plane. Each face that goes through the plane leaves one side on it; these sides,
// turned about, are the rim of new faces: as many come to a point as leave it, so they are closed loops. Faces of
// bodies that are convex but for rounding may so get faces that are not; signed volumes hold for these, too.
void ConvexSolid::cut(const ExactPoint& on, const ExactPoint& normal) {
  std::vector<std::vector<mpq_class>> heights;
  bool before = false, behind = false;
  for (const auto& face : faces_) {
    std::vector<mpq_class>& of_face = heights.emplace_back();
    for (const ExactPoint& corner : face) {
      of_face.push_back(dot(minus(corner, on), normal));
      before = before || of_face.back() > 0;
      behind = behind || of_face.back() < 0;
    }
  }
  if (!before) return;
  std::vector<std::vector<ExactPoint>> kept;
  std::map<ExactPoint, std::vector<ExactPoint>> rim;  // where sides lead to
  for (std::size_t f = 0; behind && f < faces_.size(); ++f) {
    const auto& face = faces_[f];
    const auto& height = heights[f];
    if (std::none_of(height.begin(), height.end(), [](const mpq_class& h) { return h < 0; })) continue;
    std::vector<ExactPoint> left;
    std::vector<bool> on_plane;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::size_t j = (i + 1) % face.size();
      if (height[i] <= 0) {
        left.push_back(face[i]);
        on_plane.push_back(height[i] == 0);
      }
      if ((height[i] < 0 && height[j] > 0) || (height[i] > 0 && height[j] < 0)) {
        left.push_back(between(face[i], face[j], height[i] / (height[i] - height[j])));
        on_plane.push_back(true);
      }
    }
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::size_t j = (i + 1) % left.size();
      if (on_plane[i] && on_plane[j]) rim[left[j]].push_back(left[i]);
    }
    kept.push_back(std::move(left));
  }
  faces_ = std::move(kept);
  for (auto& [start, ends] : rim) {
    while (!ends.empty()) {
      std::vector<ExactPoint> lid = {start};
      for (;;) {
        std::vector<ExactPoint>& next = rim.at(lid.back());
        const ExactPoint end = next.back();
        next.pop_back();
        if (end == start) break;
        lid.push_back(end);
      }
      if (lid.size() > 2) faces_.push_back(std::move(lid));
    }
  }
}

ConvexSolid ConvexSolid::common_with(const ConvexSolid& other) const {
  ConvexSolid left = *this;
  for (const auto& face : other.faces_) {
    left.cut(face[0], cross(minus(face[1], face[0]), minus(face[2], face[0])));
    if (left.faces_.empty()) break;
  }
  return left;
}

double ConvexSolid::volume() const {
  mpq_class six_times = 0;
  for (const auto& face : faces_) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) six_times += dot(face[0], cross(face[i], face[i + 1]));
  }
  return six_times.get_d() / 6;
}

Pieces common(const Pieces& a, const Pieces& b) {
  Pieces pieces;
  for (const ConvexSolid& piece : a) {
    for (const ConvexSolid& other : b) {
      ConvexSolid both = piece.common_with(other);
      if (both.volume() > 0) pieces.push_back(std::move(both));
    }
  }
  return pieces;
}

double volume_of(const Pieces& pieces) {
  double sum = 0;
  for (const ConvexSolid& piece : pieces) sum += piece.volume();
  return sum;
}

double volume_of_union(const std::vector<Pieces>& bodies) {
  double sum = 0;
  for (std::size_t subset = 1; subset < std::size_t{1} << bodies.size(); ++subset) {
    Pieces shared;
    int members = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if ((subset >> b & 1) == 0) continue;
      shared = members++ == 0 ? bodies[b] : common(shared, bodies[b]);
    }
    sum += (members % 2 == 1 ? 1 : -1) * volume_of(shared);
  }
  return sum;
}

}  // namespace ringdown::test
