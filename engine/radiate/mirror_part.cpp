#include "engine/radiate/mirror_part.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace ringdown::radiate {
namespace {

constexpr double kClose = 0.2, kTouching = 0.02;  // as shares of the shortest side at a node
constexpr double kAlong = 0.5;  // a unit normal with more than this across the plane: its surface runs along it

// Moves nodes that are close to the plane onto it.
void snap(mesh::TriangleMesh& surface, int axis) {
  const Eigen::Index nodes = surface.nodes.rows();
  std::vector<double> shortest(nodes, std::numeric_limits<double>::infinity());
  std::vector<bool> along(nodes, false);
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    std::array<Eigen::Vector3d, 3> at;
    for (int i = 0; i < 3; ++i) at[i] = surface.nodes.row(surface.triangles(t, i)).transpose();
    const Eigen::Vector3d normal = (at[1] - at[0]).cross(at[2] - at[0]).normalized();
    for (int i = 0; i < 3; ++i) {
      const auto n = surface.triangles(t, i);
      shortest[n] = std::min({shortest[n], (at[i] - at[(i + 1) % 3]).norm(), (at[i] - at[(i + 2) % 3]).norm()});
      along[n] = along[n] || std::abs(normal[axis]) > kAlong;
    }
  }
  for (Eigen::Index n = 0; n < nodes; ++n) {
    double& x = surface.nodes(n, axis);
    if (std::abs(x) < (along[n] ? kTouching : kClose) * shortest[n]) x = 0;
  }
}

mesh::TriangleMesh half_of(mesh::TriangleMesh surface, int axis) {
  snap(surface, axis);
  std::vector<Eigen::RowVector3d> nodes;
  for (const auto& node : surface.nodes.rowwise()) nodes.emplace_back(node);
  std::map<std::pair<int, int>, int> cuts;  // the new node between two old ones
  const auto cut = [&](int a, int b) {
    const auto [found, fresh] = cuts.emplace(std::minmax(a, b), static_cast<int>(nodes.size()));
    if (!fresh) return found->second;
    const auto [low, high] = found->first;
    const double share = nodes[low][axis] / (nodes[low][axis] - nodes[high][axis]);
    Eigen::RowVector3d at = nodes[low] + share * (nodes[high] - nodes[low]);
    at[axis] = 0;
    nodes.push_back(at);
    return found->second;
  };
  std::vector<std::array<int, 3>> triangles;
  for (const auto& row : surface.triangles.rowwise()) {
    std::vector<int> polygon;
    bool inside = false;
    for (int i = 0; i < 3; ++i) {
      const int a = row[i], b = row[(i + 1) % 3];
      const double xa = nodes[a][axis], xb = nodes[b][axis];
      inside = inside || xa > 0;
      if (xa >= 0) polygon.push_back(a);
      if (xa * xb < 0) polygon.push_back(cut(a, b));
    }
    if (!inside) continue;
    const auto length = [&](int i, int j) { return (nodes[polygon[i]] - nodes[polygon[j]]).norm(); };
    if (polygon.size() == 4 && length(1, 3) < length(0, 2))
      std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    for (std::size_t i = 2; i < polygon.size(); ++i) triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  mesh::TriangleMesh half;
  half.nodes.resize(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t n = 0; n < nodes.size(); ++n) half.nodes.row(static_cast<Eigen::Index>(n)) = nodes[n];
  half.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    half.triangles.row(static_cast<Eigen::Index>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  }
  return half;
}

}  // namespace

mesh::TriangleMesh mirror_part_of(const mesh::TriangleMesh& surface, int mirrors) {
  mesh::TriangleMesh part = surface;
  for (int axis = 0; axis < mirrors; ++axis) part = half_of(std::move(part), axis);
  return part;
}

}  // namespace ringdown::radiate
