// A surface as triangles, and its edges. As read from a file, the surface may have holes, be inside out, or cut itself.
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
  Triangles triangles;  // T x 3, numbers of nodes; counter-clockwise from outside in a sound surface
};

// The diagonal of the box around all triangles [m]; 0 if there are none.
double diagonal_of(const TriangleMesh& mesh);

// Removes the nodes that no triangle names and renumbers the remaining ones, which keep their order. O(V + T).
void drop_unused_nodes(TriangleMesh& mesh);

// One side of one triangle. In a sorted list the sides of one edge are adjacent.
struct EdgeUse {
  std::int32_t low = 0, high = 0;  // the nodes of the edge
  std::int32_t triangle = 0;
  bool forward = false;  // the triangle runs from low to high
};

// Returns all sides of the triangles marked in `usable`, sorted by edge, then by triangle.
std::vector<EdgeUse> edges_of(const TriangleMesh& mesh, const std::vector<bool>& usable);

// Returns one past the last use of the edge whose first use is edges[first].
inline std::size_t end_of_edge(const std::vector<EdgeUse>& edges, std::size_t first) {
  std::size_t last = first;
  while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high) ++last;
  return last;
}

// Returns the closed loops of `edges`, as lists of nodes. Every edge is used once, against the direction in which its
// triangle runs. Loops that meet at a node are separated there; runs of edges that do not close are left out. Adds the
// number of visited edges and nodes to `steps`. O(edges).
std::vector<std::vector<std::int32_t>> loops_of(const std::vector<EdgeUse>& edges, std::size_t* steps = nullptr);

// The area that a closed loop of nodes spans [m^2]: the length of its vector area.
double spanned_area(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop);

// Returns true if the triangle's height is below 1e-12 of its longest side or a corner is named twice.
bool is_degenerate(const TriangleMesh& mesh, Eigen::Index triangle);

// Marks the triangles whose corners equal those of an earlier triangle that is not degenerate.
std::vector<bool> duplicates_in(const TriangleMesh& mesh);

// Marks the triangles that are neither degenerate nor duplicates.
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
  std::vector<std::size_t> first_;  // beginning of each node's triangles in triangles_, and the end of the last
  std::vector<std::int32_t> triangles_;
};

// Writes a PLY text file, which every mesh tool reads; coordinates have 9 digits, in metres. Writes as described in
// output_file.h. [worker]
Result<void> write_ply(const TriangleMesh& surface, const std::filesystem::path& path);

}  // namespace ringdown::mesh
