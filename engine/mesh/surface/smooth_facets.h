// How far a curved surface lies from the flat facets that stand for it. [any thread, once made]
//
//   const SmoothFacets facets(surface);
//   const Eigen::RowVector3d way = facets.rise(triangle, point);  // from the facet to the curve
//
// Neighbours that meet at less than kSharpAngle_deg (remesh.h), and at no more than three times the angle that most
// meet at, around them or everywhere, are taken to stand for one curved surface through their corners, all others for
// an edge of the body. A box has no rise anywhere, a cylinder of n sides of radius r one of r (1 - cos(pi / n)) at the
// middle of each side.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

class SmoothFacets {
 public:
  // Keeps a reference to the surface. O(T) where no node has more than some hundred triangles.
  explicit SmoothFacets(const TriangleMesh& surface);

  // The way [m] from a point of a triangle to the curved surface, along the triangle's normal: outward where the
  // surface is convex. Which way round the triangle is wound does not matter, if its neighbours are wound as it is.
  [[nodiscard]] Eigen::RowVector3d rise(Eigen::Index triangle, const Eigen::RowVector3d& point) const;

 private:
  [[nodiscard]] Eigen::Vector3d corner(Eigen::Index t, int i) const {
    return surface_.nodes.row(surface_.triangles(t, i)).transpose();
  }
  // Returns for each node the cosine of the largest angle between two triangles there that stand for one curve.
  [[nodiscard]] std::vector<double> min_smooth_cosines(const TriangleFans& fans) const;

  const TriangleMesh& surface_;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> normals_;  // of each triangle; 0 where it has no area
  std::vector<Eigen::Vector3d> bulges_;  // of each triangle: four times the rise [m] in the middle of each side
};

}  // namespace ringdown::mesh
