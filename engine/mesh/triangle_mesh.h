// A surface as triangles, as files have it: perhaps with holes, turned inside out, or cutting itself; and its edges.
// [any thread]
#pragma once

#include "engine/base/result.h"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace ringdown::mesh {

using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct TriangleMesh {
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> nodes;  // V x 3 [m]
  Triangles triangles;  // T x 3, numbers of nodes; counter-clockwise from outside where it is sound
};

// The diagonal of the box around all triangles [m]; 0 when there are none.
double diagonal_of(const TriangleMesh& mesh);

// Removes the nodes that no triangle names and renumbers the others, which keep their order. O(V + T).
void drop_unused_nodes(TriangleMesh& mesh);

// One side of one triangle. Sides of the same edge stand beside each other in a sorted list.
struct EdgeUse {
  std::int32_t low = 0, high = 0;  // its nodes
  std::int32_t triangle = 0;
  bool forward = false;  // the triangle runs from low to high
};

// All sides of the triangles that `usable` names, sorted by edge, then by triangle.
std::vector<EdgeUse> edges_of(const TriangleMesh& mesh, const std::vector<bool>& usable);

// Past the last use of the edge whose first use is edges[first].
inline std::size_t end_of_edge(const std::vector<EdgeUse>& edges, std::size_t first) {
  std::size_t last = first;
  while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high) ++last;
  return last;
}

// The closed loops along such edges, as their nodes. Every edge is used once, against the direction that its triangle
// runs in. Loops that meet at a node are separated there; runs of edges that do not close are left out. `steps` is
// raised by the number of edges and nodes visited. O(edges).
std::vector<std::vector<std::int32_t>> loops_of(const std::vector<EdgeUse>& edges, std::size_t* steps = nullptr);

// How much a closed loop of nodes spans [m^2]: the length of its vector area.
double spanned_area(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop);

// Lower than 1e-12 of its longest side, or a corner named twice.
bool is_degenerate(const TriangleMesh& mesh, Eigen::Index triangle);

// For each triangle, whether an earlier one that is not degenerate has the same corners.
std::vector<bool> duplicates_in(const TriangleMesh& mesh);

// Neither degenerate nor a duplicate.
std::vector<bool> usable_triangles(const TriangleMesh& mesh);

// The triangles at each node, ascending. O(V + T).
class TriangleFans {
 public:
  explicit TriangleFans(const TriangleMesh& mesh);

  [[nodiscard]] std::span<const std::int32_t> at(std::int32_t node) const {
    const std::size_t first = first_[static_cast<std::size_t>(node)];
    return {triangles_.data() + first, first_[static_cast<std::size_t>(node) + 1] - first};
  }

 private:
  std::vector<std::size_t> first_;  // of each node, in triangles_, and past the last
  std::vector<std::int32_t> triangles_;
};

// A PLY text file, which every mesh tool reads; coordinates with 9 digits, in metres. Written as
// output_file.h says. [worker]
Result<void> write_ply(const TriangleMesh& surface, const std::filesystem::path& path);

}  // namespace ringdown::mesh
