#include "engine/mesh/surface_repair.h"

#include "engine/mesh/surface_edges.h"
#include "engine/mesh/surface_holes.h"

#include <algorithm>

namespace ringdown::mesh {
namespace {

constexpr double kScraps = 0.2;  // of the whole area: open parts that go, where the rest is closed

class Mender {
 public:
  explicit Mender(const TriangleMesh& mesh) : mesh_(mesh) {}

  RepairedSurface run() {
    drop_repeated();
    drop_fins();
    turn();
    const double diagonal = diagnose_size();
    Sewn sewn = sew(mesh_, kLargestHole * diagonal);
    mesh_ = std::move(sewn.mesh);
    say(sewn.sewn, "sewed %d border edge%s");
    say(sewn.closed, "closed %d hole%s");
    drop_scraps();
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

  [[nodiscard]] double diagnose_size() const {
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
    say(drop(duplicates_in(mesh_)), "dropped %d duplicated triangle%s");
    std::vector<bool> degenerate(static_cast<std::size_t>(mesh_.triangles.rows()));
    for (std::size_t t = 0; t < degenerate.size(); ++t) degenerate[t] = is_degenerate(mesh_, static_cast<Eigen::Index>(t));
    say(drop(degenerate), "dropped %d triangle%s without area");
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
  prepared.mesh = std::move(repaired.mesh);
  prepared.actions = std::move(repaired.actions);
  prepared.left = std::move(left);
  return prepared;
}

}  // namespace ringdown::mesh
