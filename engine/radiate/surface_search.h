// Finds the nearest place of a surface on the side with a given normal. [any thread, once made]
#pragma once

#include "engine/radiate/panels.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace ringdown::radiate {

struct NearestPoint {
  int triangle = -1;
  std::array<double, 3> weights{};  // weights of the triangle's corners: at least 0, sum 1
  Eigen::Vector3d at;
};

// Keeps a reference to the panels, which must live as long.
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const Panels& panels);

  // The nearest place among triangles whose normal is within 60 degrees of `normal`, which selects the right face of a
  // thin wall. If that place is more than a cell's width farther than the nearest place of all, the latter.
  [[nodiscard]] NearestPoint nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

 private:
  [[nodiscard]] std::array<int, 3> cell_of(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::size_t number_of(int x, int y, int z) const;

  const Panels& panels_;
  Eigen::Vector3d low_;
  double cell_ = 1;
  std::array<int, 3> count_{};
  std::vector<std::vector<int>> triangles_;  // triangles in each cell
  std::vector<double> radii_;                // each triangle's largest distance from its centre
};

}  // namespace ringdown::radiate
