// Estimates the distance between flat facets and the curved surface that they approximate. [any thread, once made]
//
//   const SmoothFacets facets(surface);
//   const Eigen::RowVector3d way = facets.rise(triangle, point);  // from the facet to the curve
//
// Two neighbours are taken to approximate one curved surface through their corners if they meet at less than
// kSharpAngle_deg (remesh.h) and at no more than three times the typical angle, around them or in the whole surface.
// Otherwise they meet at an edge of the body. The rise of a box is zero everywhere; the rise of a cylinder of n sides
// and radius r is r (1 - cos(pi / n)) at the middle of each side.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

#include <vector>

namespace ringdown::mesh {

class SmoothFacets {
 public:
  // Keeps a reference to the surface. O(T) if no node has more than a few hundred triangles.
  explicit SmoothFacets(const TriangleMesh& surface);

  // The vector [m] from a point of a triangle to the curved surface, along the triangle's normal: outward where the
  // surface is convex. The winding of the triangle does not matter if its neighbours are wound alike.
  [[nodiscard]] Eigen::RowVector3d rise(Eigen::Index triangle, const Eigen::RowVector3d& point) const;

 private:
  [[nodiscard]] Eigen::Vector3d corner(Eigen::Index t, int i) const {
    return surface_.nodes.row(surface_.triangles(t, i)).transpose();
  }
  // Returns for each node the cosine of the largest angle at which two triangles there count as one curved surface.
  [[nodiscard]] std::vector<double> min_smooth_cosines(const TriangleFans& fans) const;

  const TriangleMesh& surface_;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> normals_;  // per triangle; 0 if it has no area
  std::vector<Eigen::Vector3d> bulges_;  // per triangle: four times the rise [m] in the middle of each side
};

}  // namespace ringdown::mesh
