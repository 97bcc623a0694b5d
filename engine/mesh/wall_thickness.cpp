#include "engine/mesh/wall_thickness.h"

#include "engine/mesh/surface_rays.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <vector>

namespace ringdown::mesh {

double wall_thickness(const TriangleMesh& surface) {
  constexpr int kRays = 2000;
  const SurfaceRays rays(surface);
  std::vector<double> up_to;  // area
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto row = surface.triangles.row(t);
    const Eigen::RowVector3d a = surface.nodes.row(row[0]), b = surface.nodes.row(row[1]),
                             c = surface.nodes.row(row[2]);
    up_to.push_back(area += 0.5 * (b - a).cross(c - a).norm());
  }
  std::vector<double> lengths;
  for (int ray = 0; ray < kRays && area > 0; ++ray) {
    const double share = (ray + 0.5) / kRays * area;
    const auto found = std::upper_bound(up_to.begin(), up_to.end(), share) - up_to.begin();
    const double length = rays.inward(std::min<std::ptrdiff_t>(found, surface.triangles.rows() - 1));
    if (length < std::numeric_limits<double>::max()) lengths.push_back(length);
  }
  if (lengths.empty()) return 0;
  const auto low =
      lengths.begin() + static_cast<std::ptrdiff_t>(kMinThicknessShare * static_cast<double>(lengths.size()));
  std::nth_element(lengths.begin(), low, lengths.end());
  return *low;
}

}  // namespace ringdown::mesh
