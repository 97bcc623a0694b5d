// Measures distances to a surface and through the body, with CGAL's tree of boxes. [any thread, once made]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <memory>
#include <optional>

namespace ringdown::mesh {

class SurfaceRays {
 public:
  explicit SurfaceRays(const TriangleMesh& surface);
  ~SurfaceRays();
  SurfaceRays(SurfaceRays&&) noexcept;

  // The nearest point of the surface.
  [[nodiscard]] Eigen::RowVector3d nearest(const Eigen::RowVector3d& point) const;
  [[nodiscard]] Eigen::Index nearest_triangle(const Eigen::RowVector3d& point) const;

  // The distance from the middle of a triangle straight inward to the next triangle; a huge number if there is none.
  [[nodiscard]] double inward(Eigen::Index triangle) const;

  // Where a ray from a point along `direction`, of length 1, first meets a triangle: how far, and the triangle's
  // normal, of length 1. Nothing if it meets none.
  struct Hit {
    double distance_m;
    Eigen::RowVector3d normal;
  };
  [[nodiscard]] std::optional<Hit> first(const Eigen::RowVector3d& point, const Eigen::RowVector3d& direction) const;

  // The distance from a point along `direction`, of length 1, to the first triangle. A huge number if there is none, or
  // if that triangle does not face along `outward`.
  [[nodiscard]] double along(const Eigen::RowVector3d& point, const Eigen::RowVector3d& direction,
                             const Eigen::RowVector3d& outward) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// Thickness of a body's walls. [worker]

inline constexpr double kMinThicknessShare = 0.05;  // share of the area that may be thinner

// Returns the thickness [m] below which kMinThicknessShare of the surface lies, measured straight inward from up to
// 2,000 places; 0 if no ray meets anything. The surface must be turned outward; holes matter little.
double wall_thickness(const TriangleMesh& surface);

}  // namespace ringdown::mesh
