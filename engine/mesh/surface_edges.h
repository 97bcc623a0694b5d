// The edges of a surface and who uses them. [any thread]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

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

// The closed ways along such edges, each used once, as their nodes; against the triangles' own direction where they
// agree on one. Ways that meet at a node are parted there; those that do not close are left out.
std::vector<std::vector<std::int32_t>> loops_of(const std::vector<EdgeUse>& edges);

// How much a closed way of nodes spans: the length of its vector area.
double spanned_area(const TriangleMesh& mesh, const std::vector<std::int32_t>& loop);

// Lower than 1e-12 of its longest side, or a corner named twice.
bool is_degenerate(const TriangleMesh& mesh, Eigen::Index triangle);

// For each triangle, whether an earlier one that is not degenerate has the same corners.
std::vector<bool> duplicates_in(const TriangleMesh& mesh);

// Neither degenerate nor a duplicate.
std::vector<bool> usable_triangles(const TriangleMesh& mesh);

}  // namespace ringdown::mesh
