// A closed surface of flat triangles, with what boundary elements ask of it: nodes, sides and tangential fields.
// [any thread]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::radiate {

// The side between two triangles. Fields on the surface are linear on triangles, and all integrals over a triangle are
// the sum over the middles of its three sides, a third of the area each, which is exact for squares.
struct Side {
  std::array<int, 4> nodes{};      // its ends, then the corners of the two triangles that are not on it
  std::array<int, 2> triangles{};  // the one with corner nodes[2], the one with corner nodes[3]
  Eigen::Vector3d middle;
};

struct Panels {
  mesh::Points nodes;                                 // V x 3 [m]
  std::vector<std::array<int, 3>> corners;            // T, counter-clockwise from outside
  std::vector<std::array<int, 3>> sides_of;           // T, numbers of sides; the i-th lies opposite of corner i
  std::vector<Eigen::Vector3d> normals, centers;      // T
  std::vector<double> areas;                          // T
  std::vector<std::array<Eigen::Vector3d, 3>> curls;  // T, n x gradient of each corner's hat function [1/m]
  std::vector<Side> sides;

  [[nodiscard]] int node_count() const { return static_cast<int>(nodes.rows()); }
  [[nodiscard]] int triangle_count() const { return static_cast<int>(corners.size()); }
  [[nodiscard]] int side_count() const { return static_cast<int>(sides.size()); }
  [[nodiscard]] Eigen::Vector3d corner(int triangle, int i) const {
    return nodes.row(corners[triangle][i]).transpose();
  }
  [[nodiscard]] double longest_side(int triangle) const;
  [[nodiscard]] double area() const;
  [[nodiscard]] double volume() const;  // negative when it is turned inside out
};

// Fails when a side has not exactly two triangles, which run along it in opposite directions, or when a triangle has no
// area. Nodes are renumbered so that neighbours in space have close numbers; nodes without triangles go.
Result<Panels> panels_of(const mesh::TriangleMesh& surface);

}  // namespace ringdown::radiate
