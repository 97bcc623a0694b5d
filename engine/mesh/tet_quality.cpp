#include "engine/mesh/tet_quality.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace ringdown::mesh {

TetQuality quality_of(const TetMesh& mesh) {
  TetQuality quality{.shortest_edge_m = std::numeric_limits<double>::max()};
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const Corners corners = corners_of(mesh, e);
    std::array<Eigen::RowVector3d, 4> outward;
    for (int f = 0; f < 4; ++f) {
      const Eigen::RowVector3d a = corners.row(kTetFaces[f][0]), b = corners.row(kTetFaces[f][1]),
                               c = corners.row(kTetFaces[f][2]);
      outward[f] = (b - a).cross(c - a).normalized();
    }
    for (int f = 0; f < 4; ++f) {
      for (int g = f + 1; g < 4; ++g) {
        const double angle = 180 / std::numbers::pi * std::acos(std::clamp(-outward[f].dot(outward[g]), -1.0, 1.0));
        quality.smallest_angle_deg = std::min(quality.smallest_angle_deg, angle);
        quality.largest_angle_deg = std::max(quality.largest_angle_deg, angle);
      }
    }
    for (const auto& [a, b] : kTetEdges) {
      const double length = (corners.row(b) - corners.row(a)).norm();
      quality.shortest_edge_m = std::min(quality.shortest_edge_m, length);
      quality.longest_edge_m = std::max(quality.longest_edge_m, length);
    }
  }
  return quality;
}

}  // namespace ringdown::mesh
