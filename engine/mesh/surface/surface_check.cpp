#include "engine/mesh/surface/surface_check.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

// The diagnosis makes independent tests one after another (Diagnosis::run), so that all faults of a surface are
// reported: single triangles; edges (with more than two triangles: crowded; with one: the rim of a hole, and rims are
// followed into loops); shells and their nesting (shells.h); cuts; the volume.
//
// Cuts (Cutter): CGAL's box intersection, a sweep over the triangles' bounding boxes, finds the pairs that may meet.
// Exact predicates judge each pair by the number of shared corners. None: the triangles must not intersect. One: the
// side opposite the corner must not meet the other triangle. Two: the triangles must not be folded onto each other.
//
// A sheet, which encloses nothing, differs from a surface with holes by area: a sheet's openings, spanned flat, would
// be more than kSheetOpening of the closed whole.
namespace ringdown::mesh {
namespace {

constexpr double kSliver = 0.01;       // height over longest side
constexpr double kSheetOpening = 0.3;  // share of the closed whole; a hemisphere without thickness has a third
constexpr double kFlatVolume = 1e-7;   // over area times diagonal; a plate 1:1000 has 5e-4

class Diagnosis {
 public:
  Diagnosis(const TriangleMesh& mesh, CavityRule rule)
      : mesh_(mesh), usable_(usable_triangles(mesh)), shells_(shells_of(mesh, rule)) {}

  SurfaceReport run() {
    measure();
    find_unused();
    find_bad_triangles();
    look_at_edges();
    look_at_shells();
    look_at_cuts();
    judge_volume();
    std::sort(report_.findings.begin(), report_.findings.end(),
              [](const Finding& a, const Finding& b) { return a.fault < b.fault; });
    return std::move(report_);
  }

 private:
  [[nodiscard]] Eigen::RowVector3d node(std::int32_t n) const { return mesh_.nodes.row(n); }
  [[nodiscard]] Eigen::RowVector3d corner(std::int32_t t, int i) const { return node(mesh_.triangles(t, i)); }
  [[nodiscard]] Eigen::RowVector3d middle(std::int32_t t) const {
    return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
  }
  [[nodiscard]] bool usable(std::int32_t t) const { return usable_[static_cast<std::size_t>(t)]; }

  Finding& finding(Fault fault) {
    for (Finding& known : report_.findings) {
      if (known.fault == fault) return known;
    }
    return report_.findings.emplace_back(Finding{.fault = fault});
  }

  void add(Fault fault, std::int32_t triangle) { add(fault, triangle, middle(triangle)); }
  void add(Fault fault, std::int32_t triangle, const Eigen::RowVector3d& place) {
    Finding& known = finding(fault);
    ++known.count;
    if (known.places.size() >= kMaxPlaces) return;
    known.places.push_back(place);
    if (triangle >= 0) known.triangles.push_back(triangle);
  }

  void measure() {
    report_.diagonal_m = diagonal_of(mesh_);
    report_.shells = shells_.count;
    report_.area_m2 = std::accumulate(shells_.area_m2.begin(), shells_.area_m2.end(), 0.0);
  }

  void find_unused() {
    std::vector<bool> used(static_cast<std::size_t>(mesh_.nodes.rows()), false);
    for (const std::int32_t n : mesh_.triangles.reshaped()) used[static_cast<std::size_t>(n)] = true;
    for (std::size_t n = 0; n < used.size(); ++n) {
      if (!used[n]) add(Fault::kUnusedPoints, -1, node(static_cast<std::int32_t>(n)));
    }
  }

  void find_bad_triangles() {
    const std::vector<bool> copies = duplicates_in(mesh_);
    for (std::int32_t t = 0; t < mesh_.triangles.rows(); ++t) {
      if (copies[static_cast<std::size_t>(t)]) {
        add(Fault::kDuplicate, t);
      } else if (is_degenerate(mesh_, t)) {
        add(Fault::kDegenerate, t);
      } else {
        const Eigen::RowVector3d a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
        const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        if ((b - a).cross(c - a).norm() < kSliver * longest) add(Fault::kSliver, t);
      }
      if (usable(t) && shells_.turned[static_cast<std::size_t>(t)]) add(Fault::kFlipped, t);
    }
  }

  void look_at_edges() {
    const std::vector<EdgeUse> edges = edges_of(mesh_, usable_);
    std::vector<EdgeUse> open;
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      if (last - first == 1) open.push_back(edges[first]);
      if (last - first > 2) {
        add(Fault::kCrowdedEdge, edges[first].triangle, (node(edges[first].low) + node(edges[first].high)) / 2);
      }
    }
    find_holes(open);
  }

  void find_holes(const std::vector<EdgeUse>& open) {
    for (const std::vector<std::int32_t>& loop : loops_of(open)) {
      double perimeter = 0;
      for (std::size_t i = 0; i < loop.size(); ++i)
        perimeter += (node(loop[(i + 1) % loop.size()]) - node(loop[i])).norm();
      add(Fault::kHole, -1, node(loop.front()));
      Finding& known = finding(Fault::kHole);
      known.length_m = std::max(known.length_m, perimeter);
      opening_m2_ += spanned_area(mesh_, loop);
    }
  }

  void look_at_shells() {
    std::vector<std::int32_t> first(static_cast<std::size_t>(shells_.count));  // triangle of each shell
    for (auto t = static_cast<std::int32_t>(shells_.shell.size()) - 1; t >= 0; --t) {
      const std::int32_t shell = shells_.shell[static_cast<std::size_t>(t)];
      if (shell >= 0) first[static_cast<std::size_t>(shell)] = t;
    }
    int outer = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      const Role role = shells_.role[i];
      const int sign = role == Role::kBuried ? 0 : role == Role::kCavity ? -1 : 1;
      report_.volume_m3 += sign * std::abs(shells_.volume_m3[i]);
      if (!shells_.closed[i]) continue;
      if (shells_.wound_wrongly(i)) add(Fault::kInsideOut, first[i]);
      if (role == Role::kCavity) add(Fault::kCavity, first[i]);
      if (role == Role::kBuried) add(Fault::kBuried, first[i]);
      if (role == Role::kBody && ++outer > 1) add(Fault::kSeveralShells, first[i]);
    }
  }

  void look_at_cuts() {
    for (const auto& [a, b] : self_intersections(mesh_, kMaxIntersections)) {
      if (!usable(a) || !usable(b)) continue;
      const bool same = shells_.shell[static_cast<std::size_t>(a)] == shells_.shell[static_cast<std::size_t>(b)];
      add(same ? Fault::kSelfIntersection : Fault::kOverlap, a);
    }
  }

  void judge_volume() {
    const bool sheet = opening_m2_ > kSheetOpening * (report_.area_m2 + opening_m2_);
    const bool flat = std::abs(report_.volume_m3) < kFlatVolume * report_.area_m2 * report_.diagonal_m;
    if (sheet) {
      add(Fault::kSheet, 0);
    } else if (flat || !(report_.area_m2 > 0)) {
      add(Fault::kNoVolume, 0);
    }
  }

  const TriangleMesh& mesh_;
  std::vector<bool> usable_;
  Shells shells_;
  SurfaceReport report_;
  double opening_m2_ = 0;
};

}  // namespace

SurfaceReport diagnose(const TriangleMesh& mesh, CavityRule rule) { return Diagnosis(mesh, rule).run(); }

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Triangle = Kernel::Triangle_3;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::int32_t>;

struct Enough {};

class Cutter {
 public:
  Cutter(const TriangleMesh& mesh, std::size_t max) : mesh_(mesh), max_(max) {}

  std::vector<std::array<std::int32_t, 2>> run() {
    std::vector<Box> boxes;
    for (std::int32_t t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!triangle(t).is_degenerate()) boxes.emplace_back(triangle(t).bbox(), t);
    }
    try {
      CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [this](const Box& a, const Box& b) {
        const std::int32_t first = std::min<std::int32_t>(a.info(), b.info());
        const std::int32_t second = std::max<std::int32_t>(a.info(), b.info());
        if (!cut(first, second)) return;
        found_.push_back({first, second});
        if (found_.size() >= max_) throw Enough();
      });
    } catch (const Enough&) {
    }
    std::sort(found_.begin(), found_.end());
    return std::move(found_);
  }

 private:
  [[nodiscard]] std::int32_t node(std::int32_t t, int i) const { return mesh_.triangles(t, i % 3); }
  [[nodiscard]] Point point(std::int32_t t, int i) const {
    const std::int32_t n = node(t, i);
    return {mesh_.nodes(n, 0), mesh_.nodes(n, 1), mesh_.nodes(n, 2)};
  }
  [[nodiscard]] Triangle triangle(std::int32_t t) const { return {point(t, 0), point(t, 1), point(t, 2)}; }

  [[nodiscard]] bool cut(std::int32_t a, std::int32_t b) const {
    int shared = 0, at_a = 0, at_b = 0, sum_a = 0, sum_b = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (node(a, i) != node(b, j)) continue;
        ++shared;
        at_a = i;
        at_b = j;
        sum_a += i;
        sum_b += j;
      }
    }
    if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
    if (shared == 1) return meet_beyond_corner(a, at_a, b, at_b);
    return shared == 2 && folded(a, 3 - sum_a, b, 3 - sum_b);
  }

  // For triangles with one common corner. Returns true if the side opposite the corner meets the other triangle.
  [[nodiscard]] bool meet_beyond_corner(std::int32_t a, int at_a, std::int32_t b, int at_b) const {
    const Kernel::Segment_3 side_a(point(a, at_a + 1), point(a, at_a + 2)),
        side_b(point(b, at_b + 1), point(b, at_b + 2));
    return CGAL::do_intersect(side_a, triangle(b)) || CGAL::do_intersect(side_b, triangle(a));
  }

  // For triangles with a common side. Returns true if both lie in one plane, on one side of the common side.
  [[nodiscard]] bool folded(std::int32_t a, int apex_a, std::int32_t b, int apex_b) const {
    const Point p = point(a, apex_a + 1), q = point(a, apex_a + 2), r = point(a, apex_a), s = point(b, apex_b);
    return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
  }

  const TriangleMesh& mesh_;
  std::size_t max_;
  std::vector<std::array<std::int32_t, 2>> found_;
};

}  // namespace

std::vector<std::array<std::int32_t, 2>> self_intersections(const TriangleMesh& mesh, std::size_t max) {
  return Cutter(mesh, max).run();
}

}  // namespace ringdown::mesh
