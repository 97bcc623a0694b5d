#include "engine/mesh/surface/simplify.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <vector>

namespace ringdown::mesh {

TriangleMesh simplified(const TriangleMesh& surface, std::size_t triangles, double max_m) {
  const auto corners = static_cast<std::size_t>(surface.triangles.size());
  if (corners <= 3 * triangles) return surface;
  const Eigen::RowVector3d low = surface.nodes.colwise().minCoeff();
  const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> places = (surface.nodes.rowwise() - low).cast<float>();
  constexpr std::size_t kStride = 3 * sizeof(float);
  const auto count = static_cast<std::size_t>(places.rows());
  const auto extent = static_cast<double>(meshopt_simplifyScale(places.data(), count, kStride));
  const std::vector<unsigned> from(surface.triangles.data(), surface.triangles.data() + corners);
  std::vector<unsigned> to(corners);
  to.resize(meshopt_simplify(to.data(), from.data(), corners, places.data(), count, kStride, 3 * triangles,
                             static_cast<float>(max_m / extent), 0, nullptr));
  TriangleMesh fewer{.nodes = surface.nodes, .triangles = Triangles(static_cast<Eigen::Index>(to.size() / 3), 3)};
  std::copy(to.begin(), to.end(), fewer.triangles.data());
  drop_unused_nodes(fewer);
  return fewer;
}

}  // namespace ringdown::mesh
