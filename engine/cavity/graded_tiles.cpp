#include "engine/cavity/graded_tiles.h"

#include "engine/radiate/retile.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

namespace ringdown::cavity {
namespace {

// The opening at each node of the part, where no other place is near. One ray serves all nodes at a triangle of the
// walls, which are few.
std::vector<double> openings_of(const radiate::Original& original, const radiate::Panels& part) {
  constexpr double kWidest = 0.5;   // of the radius
  constexpr double kFacing = -0.5;  // cosine between normals: two walls that meet in a corner leave no opening
  const mesh::Points& nodes = original.panels->nodes;
  const double widest = kWidest * (nodes.rowwise() - nodes.colwise().mean()).rowwise().norm().maxCoeff();
  const std::vector<Eigen::Vector3d> normals = radiate::node_normals(part);
  std::vector<double> at_wall(original.walls->triangle_count(), -1), openings;
  for (int n = 0; n < part.node_count(); ++n) {
    const int wall = original.wall_search->nearest(part.nodes.row(n).transpose(), normals[n]).triangle;
    double& opening = at_wall[wall];
    if (opening < 0) {
      const radiate::Panels& surface = *original.panels;
      const int from = original.search->nearest(original.walls->centers[wall], original.walls->normals[wall]).triangle;
      const radiate::Hit hit =
          radiate::nearest_hit(surface, surface.centers[from], surface.normals[from], radiate::Face::front);
      const bool faces = hit.triangle >= 0 && surface.normals[hit.triangle].dot(surface.normals[from]) < kFacing;
      opening = faces ? std::min(widest, hit.distance_m) : widest;
    }
    openings.push_back(opening);
  }
  return openings;
}

// Lowers openings until none exceeds a neighbour's by more than the way to it. (Dijkstra's algorithm.)
void let_them_grow(const radiate::Panels& part, std::vector<double>& openings) {
  std::vector<std::vector<int>> neighbours(openings.size());
  for (const radiate::Side& side : part.sides) {
    neighbours[side.nodes[0]].push_back(side.nodes[1]);
    neighbours[side.nodes[1]].push_back(side.nodes[0]);
  }
  using Item = std::pair<double, int>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  for (int n = 0; n < part.node_count(); ++n) queue.emplace(openings[n], n);
  while (!queue.empty()) {
    const auto [opening, node] = queue.top();
    queue.pop();
    if (opening > openings[node]) continue;
    for (const int other : neighbours[node]) {
      const double reached = opening + (part.nodes.row(node) - part.nodes.row(other)).norm();
      if (reached >= openings[other]) continue;
      openings[other] = reached;
      queue.emplace(reached, other);
    }
  }
}

}  // namespace

Result<mesh::TriangleMesh> graded_tiles(const radiate::Original& original, int nodes) {
  const auto part = radiate::panels_of(original.part, original.mirrors);
  if (!part) return fail(part);
  std::vector<double> sides = openings_of(original, *part);
  let_them_grow(*part, sides);
  const double kAreaOfNode = std::sqrt(3.0) / 2;  // in equilateral triangles of side 1
  double count = 0;
  for (int t = 0; t < part->triangle_count(); ++t) {
    const auto& [a, b, c] = part->corners[t];
    const double side = (sides[a] + sides[b] + sides[c]) / 3;
    count += part->areas[t] / (kAreaOfNode * side * side);
  }
  for (double& side : sides) side *= std::sqrt(count / nodes);
  return radiate::retile(radiate::mesh_of(*part), sides, original.mirrors);
}

}  // namespace ringdown::cavity
