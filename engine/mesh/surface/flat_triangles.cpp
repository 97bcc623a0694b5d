#include "engine/mesh/surface/flat_triangles.h"

#include <algorithm>
#include <set>
#include <utility>

namespace ringdown::mesh {
namespace {

// Finds the triangles that have an edge. Triangles without area are left out.
class EdgeIndex {
 public:
  explicit EdgeIndex(const TriangleMesh& mesh) : mesh_(mesh) {
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) add(t);
  }

  void add(Eigen::Index t) {
    if (is_degenerate(mesh_, t)) return;
    for (int i = 0; i < 3; ++i) sides_.emplace(edge(t, i), t);
  }
  void remove(Eigen::Index t) {
    for (int i = 0; i < 3; ++i) sides_.erase({edge(t, i), t});
  }

  // The first triangle with that edge; -1 when there is none.
  [[nodiscard]] Eigen::Index find(std::int32_t a, std::int32_t b) const {
    const Edge wanted = std::minmax(a, b);
    const auto found = sides_.lower_bound({wanted, 0});
    return found != sides_.end() && found->first == wanted ? found->second : -1;
  }

 private:
  using Edge = std::pair<std::int32_t, std::int32_t>;  // its nodes, the lower one first

  [[nodiscard]] Edge edge(Eigen::Index t, int i) const {
    return std::minmax({mesh_.triangles(t, i), mesh_.triangles(t, (i + 1) % 3)});
  }

  const TriangleMesh& mesh_;
  std::set<std::pair<Edge, Eigen::Index>> sides_;
};

class FlatTriangles {
 public:
  FlatTriangles(TriangleMesh& mesh, std::size_t& steps) : mesh_(mesh), steps_(steps) {}

  // The two halves of a neighbour are stored in the neighbour's row and the flat triangle's. A half may be flat itself;
  // the loop handles such a half when it reaches the row.
  std::size_t run() {
    if (none()) return 0;
    EdgeIndex index(mesh_);
    std::size_t done = 0;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      ++steps_;
      if (!is_degenerate(mesh_, t)) continue;
      int longest = 0;
      for (int i = 1; i < 3; ++i) longest = side(t, i) > side(t, longest) ? i : longest;
      const std::int32_t a = mesh_.triangles(t, longest), b = mesh_.triangles(t, (longest + 1) % 3),
                         middle = mesh_.triangles(t, (longest + 2) % 3);
      if (const Eigen::Index neighbour = index.find(a, b); neighbour >= 0) {
        index.remove(neighbour);
        split_triangle(neighbour, t, a, b, middle);
        index.add(neighbour);
        index.add(t);
      }
      ++done;
    }
    drop();
    return done;
  }

 private:
  [[nodiscard]] double side(Eigen::Index t, int i) const {
    return (mesh_.nodes.row(mesh_.triangles(t, (i + 1) % 3)) - mesh_.nodes.row(mesh_.triangles(t, i))).norm();
  }

  bool none() {
    steps_ += static_cast<std::size_t>(mesh_.triangles.rows());
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (is_degenerate(mesh_, t)) return false;
    }
    return true;
  }

  void drop() {
    steps_ += 2 * static_cast<std::size_t>(mesh_.triangles.rows());
    Eigen::Index kept = 0;
    for (Eigen::Index t = 0; t < mesh_.triangles.rows(); ++t) {
      if (!is_degenerate(mesh_, t)) mesh_.triangles.row(kept++) = mesh_.triangles.row(t).eval();
    }
    mesh_.triangles.conservativeResize(kept, 3);
  }

  // Cuts triangle `t` at the point `middle` of its side a b. The halves are stored in the rows `t` and `spare`.
  void split_triangle(Eigen::Index t, Eigen::Index spare, std::int32_t a, std::int32_t b, std::int32_t middle) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t from = mesh_.triangles(t, i), to = mesh_.triangles(t, (i + 1) % 3),
                         apex = mesh_.triangles(t, (i + 2) % 3);
      if (std::minmax(from, to) != std::minmax(a, b)) continue;
      mesh_.triangles.row(t) << from, middle, apex;
      mesh_.triangles.row(spare) << middle, to, apex;
      return;
    }
  }

  TriangleMesh& mesh_;
  std::size_t& steps_;
};

}  // namespace

std::size_t split_at_flats(TriangleMesh& mesh, std::size_t& steps) { return FlatTriangles(mesh, steps).run(); }

}  // namespace ringdown::mesh
