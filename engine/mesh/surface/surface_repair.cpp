#include "engine/mesh/surface/surface_repair.h"

#include "engine/mesh/surface/denoise.h"
#include "engine/mesh/surface/flat_triangles.h"
#include "engine/mesh/surface/remesh.h"
#include "engine/mesh/surface/surface_check.h"
#include "engine/mesh/surface/unite.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace ringdown::mesh {
namespace {

// The order of repairs
//
// Each repair makes the next one possible. Coordinates are aligned first, so that faces that touch meet exactly. Walls
// and copies go first, because they put more than two triangles at an edge. Flat triangles follow, because they hide
// the edges that their neighbours should share; fins, because they leave free edges that would be taken for holes. Only
// then do neighbours agree well enough to turn flipped triangles and to find the rims of holes. Closing holes may make
// new flat triangles. Then shells are turned outward, which needs them closed, freed of noise that folds them, and
// united where they run into each other, which needs them turned. At last the surface is separated where parts of it
// still run together.
//
// Every step visits each triangle, edge and node a bounded number of times, and sorts them or looks them up in trees at
// most; `steps_` counts the visits, so that a test can hold the repair to it.

constexpr double kPlaneShare = 1e-7;  // share of the diagonal, about the rounding of files in single precision
constexpr double kScraps = 0.2;       // largest share of the area of open parts that are dropped beside a closed rest

class SurfaceRepair {
 public:
  SurfaceRepair(const TriangleMesh& mesh, CavityRule rule) : mesh_(mesh), rule_(rule) {}

  RepairedSurface run() {
    align();
    drop_repeated();
    flat_ += split_at_flats(mesh_, steps_);
    drop_fins();
    turn();
    drop_rags();
    close_holes();
    flat_ += split_at_flats(mesh_, steps_);
    say(flat_, "removed {} triangle{} without area");
    turn_outward();
    smooth_noise();
    unite_bodies();
    drop_unused_nodes(mesh_);
    mesh_ = separate(mesh_);
    drop_scraps();
    drop_unused_nodes(mesh_);
    turn_outward();
    return {std::move(mesh_), std::move(actions_), steps_, std::move(rough_)};
  }

 private:
  template <class Count>
  void say(Count count, Pattern<Count, const char*> words) {
    if (count > 0) actions_.push_back(formatted<Count, const char*>(words, count, count == 1 ? "" : "s"));
  }

  std::size_t drop(const std::vector<bool>& unwanted) {
    steps_ += unwanted.size();
    Eigen::Index kept = 0;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!unwanted[static_cast<std::size_t>(t)]) mesh_.triangles.row(kept++) = mesh_.triangles.row(t).eval();
    }
    const auto dropped = static_cast<std::size_t>(mesh_.triangles.rows() - kept);
    mesh_.triangles.conservativeResize(kept, 3);
    return dropped;
  }

  // Makes nearly equal coordinates along an axis equal, so that faces across the axis that rounding has set apart lie
  // in one plane again.
  void align() {
    const double tolerance = kPlaneShare * diagonal_of(mesh_);
    std::vector<double*> along(static_cast<std::size_t>(mesh_.nodes.rows()));
    for (auto axis : mesh_.nodes.colwise()) {
      for (std::size_t n = 0; n < along.size(); ++n) along[n] = &axis[static_cast<Eigen::Index>(n)];
      std::ranges::sort(along, {}, [](const double* x) { return *x; });
      double first = -std::numeric_limits<double>::infinity();
      for (double* const x : along) {
        if (*x - first > tolerance) first = *x;
        *x = first;
      }
    }
  }

  void drop_repeated() {
    say(drop_walls(), "dropped {} triangle{} of internal walls");
    say(drop(duplicates_in(mesh_)), "dropped {} duplicated triangle{}");
    std::vector<bool> narrow(static_cast<std::size_t>(mesh_.triangles.rows()));
    for (std::size_t t = 0; t < narrow.size(); ++t) {
      const auto row = mesh_.triangles.row(static_cast<Eigen::Index>(t));
      narrow[t] = row[0] == row[1] || row[1] == row[2] || row[2] == row[0];
    }
    flat_ += drop(narrow);
  }

  // Drops walls inside the body. Two triangles with the same corners and opposite normals are a wall left where two
  // bodies were joined; both of its sides are inside. If most triangles come in such pairs, the body was given twice,
  // once inside out, and nothing is dropped.
  std::size_t drop_walls() {
    constexpr double kMaxWallShare = 0.4;
    std::map<std::array<std::int32_t, 3>, std::array<std::vector<std::size_t>, 2>> sides;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      std::array<std::int32_t, 3> corners = {mesh_.triangles(t, 0), mesh_.triangles(t, 1), mesh_.triangles(t, 2)};
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      const bool turned = corners[1] > corners[2];
      if (turned) std::swap(corners[1], corners[2]);
      sides[corners][turned ? 1 : 0].push_back(static_cast<std::size_t>(t));
    }
    std::vector<bool> wall(static_cast<std::size_t>(mesh_.triangles.rows()), false);
    for (const auto& [corners, both] : sides) {
      if (both[0].size() != 1 || both[1].size() != 1) continue;
      wall[both[0].front()] = wall[both[1].front()] = true;
    }
    const auto count = static_cast<double>(std::count(wall.begin(), wall.end(), true));
    return count > kMaxWallShare * static_cast<double>(wall.size()) ? 0 : drop(wall);
  }

  // Returns true for a flat loop of any length, and for other loops up to `longest_m`.
  [[nodiscard]] bool may_close(const std::vector<Eigen::RowVector3d>& loop, double longest_m) const {
    constexpr double kFlat = 1e-3;  // height over length
    const auto count = loop.size();
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero(), area = middle;
    for (const Eigen::RowVector3d& at : loop) middle += at / static_cast<double>(count);
    double length = 0, height = 0;
    for (std::size_t i = 0; i < count; ++i) {
      length += (loop[(i + 1) % count] - loop[i]).norm();
      area += (loop[i] - middle).cross(loop[(i + 1) % count] - middle);
    }
    for (const Eigen::RowVector3d& at : loop) height = std::max(height, std::abs((at - middle).dot(area.normalized())));
    return length <= longest_m || height <= kFlat * length;
  }

  void close_holes() {
    const double longest_m = kMaxHole * diagonal_of(mesh_);
    std::vector<EdgeUse> open;
    const std::vector<EdgeUse> edges = all_edges();
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      if (last - first == 1) open.push_back(edges[first]);
    }
    std::vector<std::array<std::int32_t, 3>> patches;
    int closed = 0;
    for (const std::vector<std::int32_t>& loop : loops_of(open, &steps_)) {
      std::vector<Eigen::RowVector3d> points;
      for (const std::int32_t n : loop) points.emplace_back(mesh_.nodes.row(n));
      if (!may_close(points, longest_m)) continue;
      const Triangles patch = loop.size() == 3 ? Triangles(Eigen::RowVector3i(0, 1, 2)) : triangulate(points);
      for (const auto& row : patch.rowwise()) {
        patches.push_back({loop[static_cast<std::size_t>(row[0])], loop[static_cast<std::size_t>(row[1])],
                           loop[static_cast<std::size_t>(row[2])]});
      }
      closed += patch.rows() > 0;
    }
    Eigen::Index next = mesh_.triangles.rows();
    mesh_.triangles.conservativeResize(next + static_cast<Eigen::Index>(patches.size()), 3);
    for (const auto& [a, b, c] : patches) mesh_.triangles.row(next++) << a, b, c;
    say(closed, "closed {} hole{}");
  }

  // All sides of all triangles, by edge.
  std::vector<EdgeUse> all_edges() {
    const auto count = static_cast<std::size_t>(mesh_.triangles.rows());
    steps_ += 3 * count;
    return edges_of(mesh_, std::vector<bool>(count, true));
  }

  // Drops fins. A fin is a triangle with an edge that more than two triangles have and another edge that no other
  // triangle has. Each round drops all fins, which may free an edge of the triangle behind a fin and make that triangle
  // a fin for the next round. Edges only lose triangles, so a triangle can become a fin only when it is left alone at
  // an edge; the next round visits just those triangles.
  void drop_fins() {
    const std::vector<EdgeUse> edges = all_edges();
    const auto count = static_cast<std::size_t>(mesh_.triangles.rows());
    std::vector<std::size_t> first_use, uses;            // per edge: its first use, and its number of uses
    std::vector<std::array<std::size_t, 3>> own(count);  // the edges of each triangle
    std::vector<int> known(count, 0);                    // number of edges in `own` so far
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      for (std::size_t e = first; e < last; ++e) {
        const auto t = static_cast<std::size_t>(edges[e].triangle);
        own[t][static_cast<std::size_t>(known[t]++)] = uses.size();
      }
      first_use.push_back(first);
      uses.push_back(last - first);
    }
    const auto is_fin = [&](std::size_t t) {
      const auto has = [&](auto holds) { return std::any_of(own[t].begin(), own[t].end(), holds); };
      return has([&](std::size_t edge) { return uses[edge] == 1; }) &&
             has([&](std::size_t edge) { return uses[edge] > 2; });
    };
    std::vector<bool> gone(count, false);
    std::vector<std::size_t> candidates(count);
    std::iota(candidates.begin(), candidates.end(), std::size_t{0});
    while (!candidates.empty()) {
      std::vector<std::size_t> fins, touched;
      for (const std::size_t t : candidates) {
        if (!gone[t] && is_fin(t)) fins.push_back(t);
      }
      for (const std::size_t t : fins) gone[t] = true;
      for (const std::size_t t : fins) {
        for (const std::size_t edge : own[t]) {
          if (--uses[edge] == 1) touched.push_back(edge);
        }
      }
      steps_ += candidates.size() + 3 * fins.size();
      candidates.clear();
      for (const std::size_t edge : touched) {
        if (uses[edge] != 1) continue;  // the edge's last triangle was dropped in this round
        std::size_t use = first_use[edge];
        for (; gone[static_cast<std::size_t>(edges[use].triangle)]; ++use) ++steps_;
        candidates.push_back(static_cast<std::size_t>(edges[use].triangle));
      }
      std::sort(candidates.begin(), candidates.end());
      candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    }
    say(drop(gone), "dropped {} fin{}");
  }

  void flip(std::size_t t) {
    auto row = mesh_.triangles.row(static_cast<Eigen::Index>(t));
    std::swap(row[1], row[2]);
  }

  void turn() {
    const Shells shells = shells_of(mesh_);
    int turned = 0;
    for (std::size_t t = 0; t < shells.turned.size(); ++t) {
      if (!shells.turned[t]) continue;
      flip(t);
      ++turned;
    }
    say(turned, "turned {} flipped triangle{}");
  }

  void drop_scraps() {
    const Shells shells = shells_of(mesh_);
    std::vector<bool> open(shells.closed.begin(), shells.closed.end());
    open.flip();
    drop_scraps(shells, open);
  }

  // Drops the shells marked in `scraps`, unless they are too large a share of the whole.
  void drop_scraps(const Shells& shells, const std::vector<bool>& scraps) {
    double all = 0, dropped = 0;
    for (std::size_t s = 0; s < scraps.size(); ++s) {
      all += shells.area_m2[s];
      dropped += scraps[s] ? shells.area_m2[s] : 0;
    }
    const auto count = std::count(scraps.begin(), scraps.end(), true);
    if (count == 0 || dropped > kScraps * all) return;
    std::vector<bool> unwanted(shells.shell.size());
    for (std::size_t t = 0; t < unwanted.size(); ++t) {
      unwanted[t] = shells.shell[t] >= 0 && scraps[static_cast<std::size_t>(shells.shell[t])];
    }
    drop(unwanted);
    say(count, "dropped {} open scrap{}");
  }

  // Drops parts that are too wide open to be bodies, before their rims would be closed as holes.
  void drop_rags() {
    constexpr double kOpening = 0.3;
    const Shells shells = shells_of(mesh_);
    std::vector<std::vector<EdgeUse>> rims(static_cast<std::size_t>(shells.count));
    const std::vector<EdgeUse> edges = edges_of(mesh_, usable_triangles(mesh_));
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      const int shell = shells.shell[static_cast<std::size_t>(edges[first].triangle)];
      if (last - first == 1) rims[static_cast<std::size_t>(shell)].push_back(edges[first]);
    }
    std::vector<bool> rag(rims.size());
    for (std::size_t s = 0; s < rims.size(); ++s) {
      double opening = 0;
      for (const auto& loop : loops_of(rims[s], &steps_)) opening += spanned_area(mesh_, loop);
      rag[s] = opening > kOpening * (shells.area_m2[s] + opening);
    }
    drop_scraps(shells, rag);
  }

  void turn_outward() {
    const Shells shells = shells_of(mesh_, rule_);
    std::vector<bool> wrong(shells.closed.size());
    constexpr double kBulge = 1e-3;  // share of the volume of a cube of that side; flatter open parts have no outside
    for (std::size_t s = 0; s < wrong.size(); ++s) {
      const bool bulges = std::abs(shells.volume_m3[s]) > kBulge * std::pow(shells.area_m2[s], 1.5);
      wrong[s] = (shells.closed[s] || bulges) && shells.wound_wrongly(s);
    }
    for (std::size_t t = 0; t < shells.shell.size(); ++t) {
      if (shells.shell[t] >= 0 && wrong[static_cast<std::size_t>(shells.shell[t])]) flip(t);
    }
    say(std::count(wrong.begin(), wrong.end(), true), "turned {} shell{} the right way out");
  }

  // Smooths scans that noise has folded and that cut themselves in thousands of places. Uniting such a surface would
  // make it sound, but so rough that no mesh of the wanted size could follow it.
  void smooth_noise() {
    if (!is_folded_by_noise(mesh_)) return;
    const auto cuts = [](const TriangleMesh& mesh) { return self_intersections(mesh, kMaxIntersections).size(); };
    Denoised smooth = denoise(mesh_, FirstAverage::kOfFolded);
    if (cuts(smooth.mesh) > 0) {
      smooth = denoise(mesh_, FirstAverage::kOfAll);
      if (2 * cuts(smooth.mesh) > cuts(mesh_)) return;
    }
    rough_ = std::exchange(mesh_, std::move(smooth.mesh));
    actions_.push_back(formatted("smoothed noise of {:.2g} mm that folded the surface", 1000 * smooth.moved_m));
  }

  // Unites shells, several times if needed: rounding, and merging of nearly equal points, may cause new cuts in places
  // as small as the rounding, and uniting the surface again removes most of them.
  void unite_bodies() {
    constexpr int kRounds = 3;
    const auto bodies = [this] {
      const Shells shells = shells_of(mesh_);
      return std::pair(shells.count, std::count(shells.role.begin(), shells.role.end(), Role::kBuried));
    };
    const auto [before, buried] = bodies();
    const std::size_t steps = steps_;  // arrange() has a cost of its own
    bool united = false;
    for (int round = 0; round < kRounds; ++round) {
      if (self_intersections(mesh_, 1).empty() && (round > 0 || buried == 0)) break;
      Result<TriangleMesh> skin = unite(mesh_);
      if (!skin || skin->triangles.rows() == 0) break;
      mesh_ = std::move(*skin);
      drop_walls();
      drop(duplicates_in(mesh_));
      split_at_flats(mesh_, steps_);
      united = true;
    }
    steps_ = steps;
    if (!united) return;
    const int after = bodies().first;
    if (after < before) {
      actions_.push_back(formatted("united {} shells into {}", before, after));
    } else {
      actions_.emplace_back("united the surface where it intersects itself");
    }
  }

  TriangleMesh mesh_;
  std::optional<TriangleMesh> rough_;
  CavityRule rule_;
  std::size_t flat_ = 0, steps_ = 0;
  std::vector<std::string> actions_;
};

}  // namespace

RepairedSurface repair(const TriangleMesh& mesh, CavityRule rule) { return SurfaceRepair(mesh, rule).run(); }

PreparedSurface prepare(const TriangleMesh& mesh, CavityRule rule) {
  PreparedSurface prepared{
      .mesh = mesh, .found = diagnose(mesh, rule), .left = {}, .actions = {}, .notes = {}, .rough = {}};
  prepared.left = prepared.found;
  if (prepared.found.sound()) return prepared;
  RepairedSurface repaired = repair(mesh, rule);
  if (repaired.mesh.triangles.rows() == 0) return prepared;
  SurfaceReport left = diagnose(repaired.mesh);
  const auto lost = [&](Fault fault) { return left.find(fault) && !prepared.found.find(fault); };
  if (lost(Fault::kSheet) || lost(Fault::kNoVolume)) return prepared;
  prepared.mesh = std::move(repaired.mesh);
  prepared.actions = std::move(repaired.actions);
  prepared.rough = std::move(repaired.rough);
  prepared.left = std::move(left);
  return prepared;
}

}  // namespace ringdown::mesh
