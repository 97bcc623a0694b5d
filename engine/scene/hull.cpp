#include "engine/scene/hull.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace ringdown::scene {
namespace {

// One run of Qhull, freed whatever happens.
class Qhull {
 public:
  Qhull() { qh_zero(&state_, nullptr); }
  ~Qhull() {
    state_.NOerrexit = True;
    qh_freeqhull(&state_, !qh_ALL);
    int left = 0, total = 0;
    qh_memfreeshort(&state_, &left, &total);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  // Qt: triangles only; Pp: no warnings about narrow hulls. Messages go nowhere: the caller says what failed.
  bool run(std::vector<double>& coordinates) {
    char command[] = "qhull Qt Pp";
    std::FILE* silence = std::fopen("/dev/null", "w");
    if (!silence) return false;
    const int points = static_cast<int>(coordinates.size() / 3);
    const bool done = qh_new_qhull(&state_, 3, points, coordinates.data(), False, command, nullptr, silence) == 0;
    std::fclose(silence);
    return done;
  }

  qhT* get() { return &state_; }

 private:
  qhT state_;
};

// Qhull numbers points; the hull keeps only those that are corners, in order of their numbers.
Hull compact(std::span<const Vec3> points, std::vector<std::array<std::uint32_t, 3>> triangles) {
  std::set<std::uint32_t> corners;
  for (const auto& triangle : triangles) corners.insert(triangle.begin(), triangle.end());
  const std::vector<std::uint32_t> kept(corners.begin(), corners.end());
  Hull hull;
  for (const std::uint32_t corner : kept) hull.points.push_back(points[corner]);
  for (auto& triangle : triangles) {
    for (auto& corner : triangle) {
      corner = static_cast<std::uint32_t>(std::ranges::lower_bound(kept, corner) - kept.begin());
    }
  }
  hull.triangles = std::move(triangles);
  return hull;
}

Result<Hull> full_hull(std::span<const Vec3> points) {
  std::vector<double> coordinates;
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  Qhull run;
  if (points.size() < 4 || !run.run(coordinates)) {
    return fail(ErrorKind::bad_input,
                "no convex hull encloses {} points of the surface: they lie in one plane; use shape \"box\"",
                points.size());
  }
  qhT* qh = run.get();
  std::vector<std::array<std::uint32_t, 3>> triangles;
  facetT* facet;
  FORALLfacets {
    std::array<std::uint32_t, 3> corners{};
    int k = 0;
    vertexT *vertex, **vertexp;
    FOREACHvertex_(facet->vertices) {
      if (k < 3) corners[k++] = static_cast<std::uint32_t>(qh_pointid(qh, vertex->point));
    }
    const auto [a, b, c] = std::array{points[corners[0]], points[corners[1]], points[corners[2]]};
    const Vec3 outward{facet->normal[0], facet->normal[1], facet->normal[2]};
    if (dot(cross(b - a, c - a), outward) < 0) std::swap(corners[1], corners[2]);
    triangles.push_back(corners);
  }
  return compact(points, std::move(triangles));
}

// The farthest points in evenly spread directions (a Fibonacci sphere).
std::vector<Vec3> extremes(std::span<const Vec3> points) {
  std::vector<Vec3> kept;
  for (std::size_t k = 0; k < kMaxHullPoints; ++k) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / kMaxHullPoints, radius = std::sqrt(1 - z * z);
    const double angle = static_cast<double>(k) * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 direction{radius * std::cos(angle), radius * std::sin(angle), z};
    const Vec3 farthest = *std::ranges::max_element(points, {}, [&](Vec3 p) { return dot(p, direction); });
    if (std::ranges::find(kept, farthest) == kept.end()) kept.push_back(farthest);
  }
  return kept;
}

}  // namespace

// The hull by Qhull. If it has more than kMaxHullPoints corners, keeps only those that are farthest in one of
// kMaxHullPoints evenly spread directions and takes their hull, which lies within the exact one.
Result<Hull> convex_hull(std::span<const Vec3> points) {
  constexpr double kFarthest_m = 1e9;  // squares of coordinates near the end of what a double holds crash Qhull
  for (const Vec3& p : points) {
    if (length(p) <= kFarthest_m) continue;  // what is not a number is not
    return fail(ErrorKind::bad_input,
                "no convex hull encloses a surface that reaches farther than 1e9 m from its origin");
  }
  Result<Hull> hull = full_hull(points);
  if (!hull || hull->points.size() <= kMaxHullPoints) return hull;
  return full_hull(extremes(hull->points));
}

}  // namespace ringdown::scene
