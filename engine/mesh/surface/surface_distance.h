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
  [[nodiscard]] Eigen::Index nearest_triangle(const Eigen::RowVector3d& point) const;

  // How far one comes from the middle of a triangle straight inward before the surface comes again; a huge number when
  // it never does.
  [[nodiscard]] double inward(Eigen::Index triangle) const;

  // How far one comes from a point straight along `direction`, of length 1, to a triangle that is turned along
  // `outward`; a huge number when none comes, or one that is turned the other way comes first.
  [[nodiscard]] double along(const Eigen::RowVector3d& point, const Eigen::RowVector3d& direction,
                             const Eigen::RowVector3d& outward) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// How thick a body's walls are. [worker]

inline constexpr double kMinThicknessShare = 0.05;  // of the area may be thinner

// The thickness [m] below which kMinThicknessShare of the surface lies, measured from up to 2,000 places straight
// inward. The surface is turned outward; holes matter little. 0 when no ray meets anything.
double wall_thickness(const TriangleMesh& surface);

}  // namespace ringdown::mesh
