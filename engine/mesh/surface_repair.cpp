#include "engine/mesh/surface_repair.h"

#include "engine/mesh/surface_edges.h"
#include "engine/mesh/half_edges.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace ringdown::mesh {
namespace {

constexpr double kScraps = 0.2;  // of the whole area: open parts that go, where the rest is closed

class Mender {
 public:
  explicit Mender(const TriangleMesh& mesh) : mesh_(mesh) {}

  RepairedSurface run() {
    drop_repeated();
    flat_ += split_at_flats();
    drop_fins();
    turn();
    drop_rags();
    close_holes();
    flat_ += split_at_flats();
    say(flat_, "took out %d triangle%s without area");
    drop_unused_points();
    mesh_ = part(mesh_);
    drop_scraps();
    drop_unused_points();
    turn_outward();
    return {std::move(mesh_), std::move(actions_)};
  }

 private:
  void say(std::size_t count, const char* words) { say(static_cast<int>(count), words); }
  void say(int count, const char* words) {
    if (count <= 0) return;
    char text[120];
    std::snprintf(text, sizeof text, words, count, count == 1 ? "" : "s");
    actions_.emplace_back(text);
  }

  [[nodiscard]] double diagonal() const {
    Eigen::RowVector3d low = Eigen::RowVector3d::Constant(HUGE_VAL), high = -low;
    for (const std::int32_t n : mesh_.triangles.reshaped()) {
      low = low.cwiseMin(mesh_.nodes.row(n));
      high = high.cwiseMax(mesh_.nodes.row(n));
    }
    return mesh_.triangles.rows() > 0 ? (high - low).norm() : 0;
  }

  std::size_t drop(const std::vector<bool>& unwanted) {
    Eigen::Index kept = 0;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!unwanted[static_cast<std::size_t>(t)]) mesh_.triangles.row(kept++) = mesh_.triangles.row(t).eval();
    }
    const auto dropped = static_cast<std::size_t>(mesh_.triangles.rows() - kept);
    mesh_.triangles.conservativeResize(kept, 3);
    return dropped;
  }

  void drop_repeated() {
    drop_walls();
    say(drop(duplicates_in(mesh_)), "dropped %d duplicated triangle%s");
    std::vector<bool> narrow(static_cast<std::size_t>(mesh_.triangles.rows()));
    for (std::size_t t = 0; t < narrow.size(); ++t) {
      const auto row = mesh_.triangles.row(static_cast<Eigen::Index>(t));
      narrow[t] = row[0] == row[1] || row[1] == row[2] || row[2] == row[0];
    }
    flat_ += drop(narrow);
  }

  // Two triangles with the same corners that look away from each other part nothing from nothing: a wall inside, where
  // two bodies were put together. Where most triangles are such, the body was given twice, once inside out.
  void drop_walls() {
    constexpr double kMost = 0.4;
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
    if (count > kMost * static_cast<double>(wall.size())) return;
    say(drop(wall), "dropped %d triangle%s of walls inside");
  }

  void drop_unused_points() {
    std::vector<std::int32_t> number(static_cast<std::size_t>(mesh_.nodes.rows()), -1);
    std::int32_t kept = 0;
    for (const std::int32_t n : mesh_.triangles.reshaped()) number[static_cast<std::size_t>(n)] = 0;
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (number[n] < 0) continue;
      mesh_.nodes.row(kept) = mesh_.nodes.row(static_cast<Eigen::Index>(n)).eval();
      number[n] = kept++;
    }
    mesh_.nodes.conservativeResize(kept, 3);
    for (std::int32_t& n : mesh_.triangles.reshaped()) n = number[static_cast<std::size_t>(n)];
  }

  [[nodiscard]] double side(Eigen::Index t, int i) const {
    return (mesh_.nodes.row(mesh_.triangles(t, (i + 1) % 3)) - mesh_.nodes.row(mesh_.triangles(t, i))).norm();
  }

  // A triangle whose corners lie in one line goes, and its neighbour at the longest side is cut in two at the third
  // corner.
  std::size_t split_at_flats() {
    std::size_t done = 0;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!is_degenerate(mesh_, t)) continue;
      int longest = 0;
      for (int i = 1; i < 3; ++i) longest = side(t, i) > side(t, longest) ? i : longest;
      const std::int32_t a = mesh_.triangles(t, longest), b = mesh_.triangles(t, (longest + 1) % 3),
                         middle = mesh_.triangles(t, (longest + 2) % 3);
      split_neighbour(t, a, b, middle);
      ++done;
    }
    if (done > 0) drop(flats());
    return done;
  }

  [[nodiscard]] std::vector<bool> flats() const {
    std::vector<bool> flat(static_cast<std::size_t>(mesh_.triangles.rows()));
    for (std::size_t t = 0; t < flat.size(); ++t) flat[t] = is_degenerate(mesh_, static_cast<Eigen::Index>(t));
    return flat;
  }

  // Its halves: one in its own row, the other in the flat triangle's.
  void split_neighbour(Eigen::Index flat, std::int32_t a, std::int32_t b, std::int32_t middle) {
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (t == flat || is_degenerate(mesh_, t)) continue;
      for (int i = 0; i < 3; ++i) {
        const std::int32_t from = mesh_.triangles(t, i), to = mesh_.triangles(t, (i + 1) % 3),
                           apex = mesh_.triangles(t, (i + 2) % 3);
        if (std::minmax(from, to) != std::minmax(a, b)) continue;
        mesh_.triangles.row(t) << from, middle, apex;
        mesh_.triangles.row(flat) << middle, to, apex;
        return;
      }
    }
  }

  // Flat ways are spanned whatever their length.
  [[nodiscard]] bool may_close(const std::vector<Eigen::RowVector3d>& way, double longest_m) const {
    constexpr double kFlat = 1e-3;  // of the length
    const auto count = way.size();
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero(), area = middle;
    for (const Eigen::RowVector3d& at : way) middle += at / static_cast<double>(count);
    double length = 0, height = 0;
    for (std::size_t i = 0; i < count; ++i) {
      length += (way[(i + 1) % count] - way[i]).norm();
      area += (way[i] - middle).cross(way[(i + 1) % count] - middle);
    }
    for (const Eigen::RowVector3d& at : way) height = std::max(height, std::abs((at - middle).dot(area.normalized())));
    return length <= longest_m || height <= kFlat * length;
  }

  void close_holes() {
    const double longest_m = kMaxHole * diagonal();
    std::vector<EdgeUse> open;
    const std::vector<EdgeUse> edges =
        edges_of(mesh_, std::vector<bool>(static_cast<std::size_t>(mesh_.triangles.rows()), true));
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
      last = end_of_edge(edges, first);
      if (last - first == 1) open.push_back(edges[first]);
    }
    int closed = 0;
    for (const std::vector<std::int32_t>& loop : loops_of(open)) {
      std::vector<Eigen::RowVector3d> way;
      for (const std::int32_t n : loop) way.emplace_back(mesh_.nodes.row(n));
      if (!may_close(way, longest_m)) continue;
      const Triangles patch = loop.size() == 3 ? Triangles(Eigen::RowVector3i(0, 1, 2)) : span(way);
      const Eigen::Index before = mesh_.triangles.rows();
      mesh_.triangles.conservativeResize(before + patch.rows(), 3);
      for (Eigen::Index t = 0; t < patch.rows(); ++t) {
        for (int i = 0; i < 3; ++i) mesh_.triangles(before + t, i) = loop[static_cast<std::size_t>(patch(t, i))];
      }
      closed += patch.rows() > 0;
    }
    say(closed, "closed %d hole%s");
  }

  void drop_fins() {
    std::size_t dropped = 0;
    for (;;) {
      const auto count = static_cast<std::size_t>(mesh_.triangles.rows());
      std::vector<bool> crowded(count, false), free(count, false), fin(count, false);
      const std::vector<EdgeUse> edges = edges_of(mesh_, std::vector<bool>(count, true));
      for (std::size_t first = 0, last; first < edges.size(); first = last) {
        last = end_of_edge(edges, first);
        for (std::size_t e = first; e < last; ++e) {
          const auto t = static_cast<std::size_t>(edges[e].triangle);
          if (last - first == 1) free[t] = true;
          if (last - first > 2) crowded[t] = true;
        }
      }
      for (std::size_t t = 0; t < count; ++t) fin[t] = crowded[t] && free[t];
      const std::size_t gone = drop(fin);
      if (gone == 0) break;
      dropped += gone;
    }
    say(dropped, "dropped %d fin%s");
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
    say(turned, "turned %d flipped triangle%s");
  }

  void drop_scraps() {
    const Shells shells = shells_of(mesh_);
    double open = 0, all = 0;
    int scraps = 0;
    for (std::size_t s = 0; s < shells.closed.size(); ++s) {
      all += shells.area_m2[s];
      if (shells.closed[s]) continue;
      open += shells.area_m2[s];
      ++scraps;
    }
    if (scraps == 0 || open > kScraps * all) return;
    std::vector<bool> unwanted(shells.shell.size());
    for (std::size_t t = 0; t < unwanted.size(); ++t) {
      unwanted[t] = shells.shell[t] >= 0 && !shells.closed[static_cast<std::size_t>(shells.shell[t])];
    }
    drop(unwanted);
    say(scraps, "dropped %d open scrap%s");
  }

  // Open parts that are wider open than a body would be, before their rims are taken for holes.
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
    double all = 0, ragged = 0;
    std::vector<bool> rag(rims.size());
    for (std::size_t s = 0; s < rims.size(); ++s) {
      double opening = 0;
      for (const auto& loop : loops_of(rims[s])) opening += spanned_area(mesh_, loop);
      rag[s] = opening > kOpening * (shells.area_m2[s] + opening);
      all += shells.area_m2[s];
      ragged += rag[s] ? shells.area_m2[s] : 0;
    }
    const auto count = std::count(rag.begin(), rag.end(), true);
    if (count == 0 || ragged > kScraps * all) return;
    std::vector<bool> unwanted(shells.shell.size());
    for (std::size_t t = 0; t < unwanted.size(); ++t) {
      unwanted[t] = shells.shell[t] >= 0 && rag[static_cast<std::size_t>(shells.shell[t])];
    }
    drop(unwanted);
    say(count, "dropped %d open scrap%s");
  }

  void turn_outward() {
    const Shells shells = shells_of(mesh_);
    std::vector<bool> wrong(shells.closed.size());
    for (std::size_t s = 0; s < wrong.size(); ++s) wrong[s] = (shells.volume_m3[s] < 0) != (shells.depth[s] % 2 == 1);
    for (std::size_t t = 0; t < shells.shell.size(); ++t) {
      if (shells.shell[t] >= 0 && wrong[static_cast<std::size_t>(shells.shell[t])]) flip(t);
    }
    say(std::count(wrong.begin(), wrong.end(), true), "turned %d shell%s the right way out");
  }
  void say(std::ptrdiff_t count, const char* words) { say(static_cast<int>(count), words); }

  TriangleMesh mesh_;
  std::size_t flat_ = 0;
  std::vector<std::string> actions_;
};

}  // namespace

RepairedSurface repair(const TriangleMesh& mesh) { return Mender(mesh).run(); }

PreparedSurface prepare(const TriangleMesh& mesh) {
  PreparedSurface prepared{.mesh = mesh, .found = diagnose(mesh), .left = {}, .actions = {}};
  prepared.left = prepared.found;
  if (prepared.found.sound()) return prepared;
  RepairedSurface repaired = repair(mesh);
  if (repaired.mesh.triangles.rows() == 0) return prepared;
  SurfaceReport left = diagnose(repaired.mesh);
  const auto lost = [&](Fault fault) { return left.find(fault) && !prepared.found.find(fault); };
  if (lost(Fault::kSheet) || lost(Fault::kNoVolume)) return prepared;
  prepared.mesh = std::move(repaired.mesh);
  prepared.actions = std::move(repaired.actions);
  prepared.left = std::move(left);
  return prepared;
}

}  // namespace ringdown::mesh
