// Dihedral angles, and the volume, of straight tetrahedra.
#pragma once

#include "engine/mesh/tet_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ringdown::test {

struct Dihedral {
  double min = 180, max = 0;  // [degrees]
  double volume = 0;
};

// By spherical trigonometry from the angles of the faces at each corner.
inline Dihedral dihedral(const mesh::TetMesh& mesh) {
  Dihedral found;
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::Corners x = mesh::corners_of(mesh, e);
    const auto between = [&](int at, int a, int b) {
      const Eigen::RowVector3d u = x.row(a) - x.row(at), v = x.row(b) - x.row(at);
      return std::atan2(u.cross(v).norm(), u.dot(v));
    };
    for (int at = 0; at < 4; ++at) {
      for (int to = 0; to < 4; ++to) {
        if (to == at) continue;
        int others[2], count = 0;
        for (int k = 0; k < 4; ++k) {
          if (k != at && k != to) others[count++] = k;
        }
        const double a = between(at, others[0], others[1]), b = between(at, to, others[0]),
                     c = between(at, to, others[1]);
        const double cosine = (std::cos(a) - std::cos(b) * std::cos(c)) / (std::sin(b) * std::sin(c));
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
        found.min = std::min(found.min, angle);
        found.max = std::max(found.max, angle);
      }
    }
    const Eigen::Matrix3d edges = x.bottomRows<3>().rowwise() - x.row(0);
    found.volume += edges.determinant() / 6;
  }
  return found;
}

}  // namespace ringdown::test
