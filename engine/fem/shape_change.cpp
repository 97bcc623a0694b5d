#include "engine/fem/shape_change.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <array>

// The displacements of a face's nodes, for all modes side by side, give the values and the slopes along two sides at
// the face's points. The slopes are converted to two perpendicular directions in the surface. They give the
// strains e11, e22 and 2 e12 in the plane of the surface, and with them
//
//   sigma : epsilon = E/(1 - nu^2) (e11^2 + e22^2 + 2 nu e11 e22 + (1 - nu)/2 (2 e12)^2).
namespace ringdown::fem {
namespace {

using mesh::kPointsPerFace;

struct Frame {
  Eigen::Matrix<double, 3, 2> directions;  // orthonormal, in the plane of the surface at a point
  Eigen::Matrix2d from_sides;              // slopes along the directions = slopes along the sides * from_sides
};

Frame frame_of(const Eigen::Vector3d& second, const Eigen::Vector3d& third) {
  Frame frame;
  const Eigen::Vector3d normal = second.cross(third).normalized();
  frame.directions.col(0) = second.normalized();
  frame.directions.col(1) = normal.cross(frame.directions.col(0));
  Eigen::Matrix2d sides;  // column i: side i along the two directions
  sides << frame.directions.transpose() * second, frame.directions.transpose() * third;
  frame.from_sides = sides.inverse();
  return frame;
}

// The stiffness of a plane state of stress in the surface, for e11, e22 and 2 e12 along the frame's directions: the
// strains across the surface are those without traction.
Eigen::Matrix3d plane_stiffness(const Matrix6& stiffness, const Frame& frame) {
  Eigen::Matrix3d axes;  // rows: the frame's directions and the normal, in the axes of the mesh
  axes << frame.directions.transpose(), frame.directions.col(0).cross(frame.directions.col(1)).transpose();
  const Matrix6 local = rotated(stiffness, axes);
  const Eigen::Array3i in(0, 1, 5), out(2, 3, 4);
  const Eigen::Matrix3d coupling = local(in, out), across = local(out, out);
  return local(in, in) - coupling * across.inverse() * coupling.transpose();
}

}  // namespace

Eigen::VectorXd lambda_changes(const mesh::FacePoints& points, const mesh::Boundary& surface,
                               const Eigen::Ref<const Eigen::VectorXd>& gaps, const Solid& solid,
                               const Eigen::Ref<const Eigen::VectorXd>& lambda,
                               const Eigen::Ref<const Eigen::MatrixXd>& shapes) {
  const Eigen::Index n = points.nodes.cols(), modes = shapes.cols();
  int order = 1;
  while ((order + 1) * (order + 2) / 2 < n) ++order;
  std::array<mesh::FaceFunctions, 4> functions;
  for (int f = 0; f < 4; ++f) functions[f] = mesh::face_functions(order, f);

  Eigen::VectorXd changes = Eigen::VectorXd::Zero(modes);
  Eigen::MatrixXd moves(n, 3 * modes);  // mode by mode, x y z
  for (Eigen::Index f = 0; f < points.nodes.rows(); ++f) {
    if (gaps.segment<kPointsPerFace>(f * kPointsPerFace).isZero(0)) continue;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index row =
          std::lower_bound(surface.nodes.begin(), surface.nodes.end(), points.nodes(f, k)) - surface.nodes.begin();
      for (Eigen::Index m = 0; m < modes; ++m) moves.row(k).segment<3>(3 * m) = shapes.col(m).segment<3>(3 * row);
    }
    const Law& law = solid.at(points.elements[static_cast<std::size_t>(f)]);
    const Elastic& elastic = law.elastic;
    const double nu = elastic.poisson_ratio, plane = elastic.youngs_modulus_pa / (1 - nu * nu);
    const mesh::FaceFunctions& at = functions[points.opposite[f]];
    const Eigen::MatrixXd values = at.values * moves, second = at.along_second * moves, third = at.along_third * moves;
    for (Eigen::Index i = 0; i < kPointsPerFace; ++i) {
      const Eigen::Index p = f * kPointsPerFace + i;
      const double weight = gaps[p] * points.areas[p];
      if (weight == 0) continue;
      const Frame frame = frame_of(points.second.row(p), points.third.row(p));
      const Eigen::Matrix3d in_plane =
          law.stiffness_pa ? plane_stiffness(*law.stiffness_pa, frame) : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
      for (Eigen::Index m = 0; m < modes; ++m) {
        Eigen::Matrix<double, 3, 2> slopes;
        slopes << second.row(i).segment<3>(3 * m).transpose(), third.row(i).segment<3>(3 * m).transpose();
        const Eigen::Matrix2d strain = frame.directions.transpose() * slopes * frame.from_sides;
        const double e11 = strain(0, 0), e22 = strain(1, 1), shear = strain(0, 1) + strain(1, 0);
        const Eigen::Vector3d strains(e11, e22, shear);
        const double energy = law.stiffness_pa
                                  ? strains.dot(in_plane * strains)
                                  : plane * (e11 * e11 + e22 * e22 + 2 * nu * e11 * e22 + (1 - nu) / 2 * shear * shear);
        const double motion = elastic.density_kg_m3 * values.row(i).segment<3>(3 * m).squaredNorm();
        changes[m] += weight * (energy - lambda[m] * motion);
      }
    }
  }
  return changes;
}

}  // namespace ringdown::fem
