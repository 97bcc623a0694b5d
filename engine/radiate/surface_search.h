// The nearest place of a surface on the side that one looks at. [any thread, once made]
#pragma once

#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::radiate {

struct NearestPoint {
  int triangle = -1;
  std::array<double, 3> weights{};  // of its corners, at least 0, sum 1
  Eigen::Vector3d at;
};

// Keeps a reference to the panels, which must live as long.
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const Panels& panels);

  // Nearest among the triangles whose normal is within 60 degrees of `normal`: of a thin wall's two faces the right
  // one. Where there is none within a cell's width of the nearest of all, that one.
  [[nodiscard]] NearestPoint nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

 private:
  [[nodiscard]] std::array<int, 3> cell_of(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::size_t number_of(int x, int y, int z) const;

  const Panels& panels_;
  Eigen::Vector3d low_;
  double cell_ = 1;
  std::array<int, 3> count_{};
  std::vector<std::vector<int>> triangles_;  // in each cell
  std::vector<double> radii_;                // of the circle around each triangle's centre that holds it
};

}  // namespace ringdown::radiate
