#include "engine/radiate/body.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::radiate {

FlowSamples flow_of(const mesh::TriangleMesh& surface, const std::vector<Eigen::MatrixX3d>& displacement,
                    double max_edge_m) {
  struct Patch {
    Eigen::Index triangle;
    int parts;                               // number of parts of each side of the triangle
    std::array<Eigen::Vector3d, 3> corners;  // barycentric
  };
  std::vector<Patch> patches;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto node = [&](int i) { return Eigen::Vector3d(surface.nodes.row(surface.triangles(t, i)).transpose()); };
    double longest = 0;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, (node(i) - node((i + 1) % 3)).norm());
    const int parts = max_edge_m > 0 ? std::max(1, static_cast<int>(std::ceil(longest / max_edge_m))) : 1;
    const auto at = [&](int i, int j) {
      return Eigen::Vector3d(1 - static_cast<double>(i + j) / parts, static_cast<double>(i) / parts,
                             static_cast<double>(j) / parts);
    };
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        patches.push_back({t, parts, {at(i, j), at(i + 1, j), at(i, j + 1)}});
        if (i + j + 1 < parts) patches.push_back({t, parts, {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}});
      }
    }
  }
  FlowSamples samples;
  const auto count = static_cast<Eigen::Index>(3 * patches.size());
  samples.positions.resize(count, 3);
  samples.normals.resize(count, 3);
  samples.areas.resize(count);
  samples.flow.resize(count, static_cast<Eigen::Index>(displacement.size()));
  for (Eigen::Index p = 0; p < static_cast<Eigen::Index>(patches.size()); ++p) {
    const auto& [t, parts, corners] = patches[p];
    std::array<Eigen::Vector3d, 3> node;
    for (int i = 0; i < 3; ++i) node[i] = surface.nodes.row(surface.triangles(t, i)).transpose();
    const Eigen::Vector3d twice = (node[1] - node[0]).cross(node[2] - node[0]);
    const double area = twice.norm() / 2 / (parts * parts);
    for (int e = 0; e < 3; ++e) {
      const Eigen::Index row = 3 * p + e;
      const Eigen::Vector3d w = (corners[e] + corners[(e + 1) % 3]) / 2;
      samples.positions.row(row) = (w[0] * node[0] + w[1] * node[1] + w[2] * node[2]).transpose();
      samples.normals.row(row) = twice.normalized().transpose();
      samples.areas[row] = area / 3;
      for (std::size_t m = 0; m < displacement.size(); ++m) {
        double along = 0;
        for (int i = 0; i < 3; ++i)
          along += w[i] * displacement[m].row(surface.triangles(t, i)).dot(samples.normals.row(row));
        samples.flow(row, static_cast<Eigen::Index>(m)) = static_cast<float>(along * area / 3);
      }
    }
  }
  return samples;
}

}  // namespace ringdown::radiate
