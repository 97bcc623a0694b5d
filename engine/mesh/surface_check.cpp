#include "engine/mesh/surface_check.h"

#include "engine/mesh/surface_cuts.h"
#include "engine/mesh/surface_edges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace ringdown::mesh {
namespace {

constexpr double kSliver = 0.01;       // height over longest side
constexpr double kSheetOpening = 0.3;  // of the closed whole; half of a sphere without thickness: a third
constexpr double kFlatVolume = 1e-7;   // over area times diagonal; a plate 1:1000 has 5e-4

class Diagnosis {
 public:
  explicit Diagnosis(const TriangleMesh& mesh)
      : mesh_(mesh), usable_(usable_triangles(mesh)), shells_(shells_of(mesh)) {}

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
    Eigen::RowVector3d low = Eigen::RowVector3d::Constant(HUGE_VAL), high = -low;
    for (const std::int32_t n : mesh_.triangles.reshaped()) {
      low = low.cwiseMin(mesh_.nodes.row(n));
      high = high.cwiseMax(mesh_.nodes.row(n));
    }
    report_.diagonal_m = mesh_.triangles.rows() > 0 ? (high - low).norm() : 0;
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

  [[nodiscard]] std::int32_t first_of(int shell) const {
    return static_cast<std::int32_t>(std::find(shells_.shell.begin(), shells_.shell.end(), shell) -
                                     shells_.shell.begin());
  }

  void look_at_shells() {
    int outer = 0;
    for (int s = 0; s < shells_.count; ++s) {
      const auto i = static_cast<std::size_t>(s);
      const bool inside = shells_.depth[i] % 2 == 1;
      report_.volume_m3 += (inside ? -1 : 1) * std::abs(shells_.volume_m3[i]);
      if (!shells_.closed[i]) continue;
      if ((shells_.volume_m3[i] < 0) != inside) add(Fault::kInsideOut, first_of(s));
      if (inside) add(Fault::kCavity, first_of(s));
      if (!inside && ++outer > 1) add(Fault::kSeveralShells, first_of(s));
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

struct Words {
  const char *one, *many;
};

Words words_of(Fault fault) {
  switch (fault) {
    case Fault::kUnusedPoints:
      return {"point of no triangle", "points of no triangle"};
    case Fault::kDegenerate:
      return {"triangle without area", "triangles without area"};
    case Fault::kDuplicate:
      return {"duplicated triangle", "duplicated triangles"};
    case Fault::kSliver:
      return {"sliver", "slivers"};
    case Fault::kCrowdedEdge:
      return {"edge with more than two triangles", "edges with more than two triangles"};
    case Fault::kHole:
      return {"hole", "holes"};
    case Fault::kFlipped:
      return {"flipped triangle", "flipped triangles"};
    case Fault::kSelfIntersection:
      return {"self-intersection", "self-intersections"};
    case Fault::kInsideOut:
      return {"shell inside out", "shells inside out"};
    case Fault::kSeveralShells:
      return {"further separate shell", "further separate shells"};
    case Fault::kCavity:
      return {"cavity", "cavities"};
    case Fault::kOverlap:
      return {"intersection between shells", "intersections between shells"};
    case Fault::kSheet:
      return {"open sheet", "open sheets"};
    case Fault::kNoVolume:
      return {"surface without volume", "surfaces without volume"};
  }
  return {"fault", "faults"};
}

std::string with_place(const Finding& finding) {
  if (finding.places.empty()) return "";
  char text[96];
  const Eigen::RowVector3d& at = finding.places.front();
  std::snprintf(text, sizeof text, ", %sat (%.4g, %.4g, %.4g) m", finding.count > 1 ? "the first " : "", at[0], at[1],
                at[2]);
  return text;
}

}  // namespace

const Finding* SurfaceReport::find(Fault fault) const {
  const auto found =
      std::find_if(findings.begin(), findings.end(), [fault](const Finding& f) { return f.fault == fault; });
  return found == findings.end() ? nullptr : &*found;
}

bool SurfaceReport::closed() const { return !find(Fault::kHole) && !find(Fault::kCrowdedEdge); }

bool SurfaceReport::sound() const {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return is_harmless(f.fault); });
}

bool is_harmless(Fault fault) {
  return fault == Fault::kUnusedPoints || fault == Fault::kSliver || fault == Fault::kSeveralShells ||
         fault == Fault::kCavity;
}

SurfaceReport diagnose(const TriangleMesh& mesh) { return Diagnosis(mesh).run(); }

std::string name_of(Fault fault) { return words_of(fault).many; }

std::string describe(const Finding& finding) {
  const Words words = words_of(finding.fault);
  const bool cuts = finding.fault == Fault::kSelfIntersection || finding.fault == Fault::kOverlap;
  std::string text = cuts && finding.count >= kMaxIntersections ? "at least " : "";
  text += std::to_string(finding.count) + " " + (finding.count == 1 ? words.one : words.many);
  if (finding.length_m > 0) {
    char around[64];
    std::snprintf(around, sizeof around, ", %s%.3g m around", finding.count > 1 ? "the longest " : "",
                  finding.length_m);
    text += around;
  }
  return text + with_place(finding);
}

}  // namespace ringdown::mesh
