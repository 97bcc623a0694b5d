// Distances to a surface and through it. By CGAL's tree of boxes. [any thread, once made]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <memory>

namespace ringdown::mesh {

class SurfaceRays {
 public:
  explicit SurfaceRays(const TriangleMesh& surface);
  ~SurfaceRays();
  SurfaceRays(SurfaceRays&&) noexcept;

  // The nearest point of the surface.
  [[nodiscard]] Eigen::RowVector3d nearest(const Eigen::RowVector3d& point) const;

  // How far one comes from the middle of a triangle straight inward before the surface comes again; a huge number when
  // it never does.
  [[nodiscard]] double inward(Eigen::Index triangle) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace ringdown::mesh
