// Measures of a surface, for comparison with closed forms.
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Geometry>

namespace ringdown::test {

// Below 0 where it is inside out.
inline double volume_of(const mesh::TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& row : mesh.triangles.rowwise()) {
    const Eigen::RowVector3d a = mesh.nodes.row(row[0]), b = mesh.nodes.row(row[1]), c = mesh.nodes.row(row[2]);
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

inline Eigen::RowVector3d extent_of(const mesh::TriangleMesh& mesh) {
  return mesh.nodes.colwise().maxCoeff() - mesh.nodes.colwise().minCoeff();
}

}  // namespace ringdown::test
