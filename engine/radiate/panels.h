// A closed surface of flat triangles, with nodes, sides and tangential fields for boundary elements. [any thread]
//
// Panels may be a part of a surface that has mirror planes. The planes are then coordinate planes through the origin,
// across the first one, two or three axes. The part lies where these coordinates are not negative, and its images make
// up the whole surface. Bit a of an image's number says that the image is mirrored across axis a; image 0 is the part
// itself.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::radiate {

// The side between two triangles. Fields are linear on triangles. Every integral over a triangle is the sum over the
// middles of its three sides, each with a third of the area, which is exact for quadratic functions.
struct Side {
  std::array<int, 4> nodes{};      // the side's ends, then the opposite corners of the two triangles
  std::array<int, 2> triangles{};  // those with corner nodes[2] and nodes[3]; -1 across a mirror plane
  Eigen::Vector3d middle;
};

// The mirror planes on which a point lies: bit a where its coordinate a is exactly 0.
int mirror_planes_at(const Eigen::Vector3d& point, int mirrors);

struct Panels {
  mesh::Points nodes;                                 // V x 3 [m]
  std::vector<std::array<int, 3>> corners;            // T, counter-clockwise from outside
  std::vector<std::array<int, 3>> sides_of;           // T, numbers of sides; the i-th lies opposite corner i
  std::vector<Eigen::Vector3d> normals, centers;      // T
  std::vector<double> areas;                          // T
  std::vector<std::array<Eigen::Vector3d, 3>> curls;  // T, n x gradient of each corner's hat function [1/m]
  std::vector<Side> sides;
  int mirrors = 0;  // number of mirror planes, 0 to 3

  [[nodiscard]] int image_count() const { return 1 << mirrors; }
  // The mirror planes on which a node lies, as bits.
  [[nodiscard]] int planes_at(int node) const { return mirror_planes_at(nodes.row(node).transpose(), mirrors); }
  [[nodiscard]] int node_count() const { return static_cast<int>(nodes.rows()); }
  [[nodiscard]] int triangle_count() const { return static_cast<int>(corners.size()); }
  [[nodiscard]] int side_count() const { return static_cast<int>(sides.size()); }
  [[nodiscard]] Eigen::Vector3d corner(int triangle, int i) const {
    return nodes.row(corners[triangle][i]).transpose();
  }
  [[nodiscard]] double longest_side(int triangle) const;
  [[nodiscard]] double area() const;
  [[nodiscard]] double volume() const;  // negative when the surface is inside out
};

// Fails unless each side has exactly two triangles, which run along it in opposite directions, or exactly one on a
// mirror plane. Also fails when a triangle has no area. Nodes are renumbered so that neighbours in space have close
// numbers; nodes without triangles are dropped.
Result<Panels> panels_of(const mesh::TriangleMesh& surface, int mirrors = 0);

// The triangles in another form.
mesh::TriangleMesh mesh_of(const Panels& panels);

// The nearest triangle that shows a ray its front, as seen from outside of the body, or its back. Without one the
// distance is infinite. (Moeller & Trumbore 1997.)
enum class Face { front, back };
struct Hit {
  double distance_m = 0;
  int triangle = -1;
};
Hit nearest_hit(const Panels& panels, const Eigen::Vector3d& start, const Eigen::Vector3d& way, Face shown);

// The image of a point.
Eigen::Vector3d image_of(const Eigen::Vector3d& point, int image);
// The image of a part, turned so that its normals point outward. Nodes, sides and triangles keep their numbers.
Panels image_of(const Panels& part, int image);

}  // namespace ringdown::radiate
