#include "engine/fem/surface_stress.h"

#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/fem/blas_threads.h"
#include "engine/mesh/face_points.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

// On a face the displacement is a sum over the face's nodes of N_a u_a, and N_a is given along two sides A, B of the
// face, which need be neither perpendicular nor of length 1. Its gradient in the tangent plane is
//
//   g_a = dN_a/dA A* + dN_a/dB B*,      A* . A = B* . B = 1,   A* . B = B* . A = 0
//
// so the strains along tangents t1, t2 are sums over a of (t1 . u_a) (t1 . g_a) and so on.
namespace ringdown::fem {
namespace {

using mesh::kPointsPerFace;

// Numbers of points, at most `count`, each the farthest from those before it.
std::vector<Eigen::Index> spread_points(const mesh::Points& positions, Eigen::Index count) {
  const Eigen::RowVector3d middle = positions.colwise().mean();
  std::vector<Eigen::Index> chosen(1);
  (positions.rowwise() - middle).rowwise().squaredNorm().maxCoeff(&chosen[0]);
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(positions.rows(), std::numeric_limits<double>::infinity());
  while (static_cast<Eigen::Index>(chosen.size()) < std::min(count, positions.rows())) {
    const Eigen::RowVector3d last = positions.row(chosen.back());
    for (Eigen::Index p = 0; p < positions.rows(); ++p)
      distance[p] = std::min(distance[p], (positions.row(p) - last).squaredNorm());
    Eigen::Index farthest = 0;
    if (distance.maxCoeff(&farthest) <= 0) break;
    chosen.push_back(farthest);
  }
  return chosen;
}

// Columns are two tangents and the normal. The first tangent follows one side of the face.
Eigen::Matrix3d frame_at(const mesh::FacePoints& points, Eigen::Index p) {
  Eigen::Matrix3d frame;
  frame.col(2) = points.normals.row(p).transpose();
  frame.col(0) = points.second.row(p).transpose().normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// 3 x 3n: maps displacements of a face's n nodes to e11, e22 and 2 e12 at one of its points.
Eigen::MatrixXd strain_of_nodes(const mesh::FacePoints& points, Eigen::Index p, const Eigen::Matrix3d& frame,
                                const Eigen::Ref<const Eigen::MatrixXd>& sides) {
  // Sides in the frame: column s has the components of side s along the tangents.
  Eigen::Matrix2d along;
  along.col(0) = frame.leftCols<2>().transpose() * points.second.row(p).transpose();
  along.col(1) = frame.leftCols<2>().transpose() * points.third.row(p).transpose();
  const double determinant = along(0, 0) * along(1, 1) - along(0, 1) * along(1, 0);
  Eigen::Matrix2d dual;
  dual << along(1, 1), -along(1, 0), -along(0, 1), along(0, 0);
  dual /= determinant;
  const Eigen::Vector3d first = frame.col(0), second = frame.col(1);
  Eigen::MatrixXd strain(3, 3 * sides.rows());
  for (Eigen::Index a = 0; a < sides.rows(); ++a) {
    const Eigen::Vector2d g = dual * sides.row(a).transpose();
    strain.block<1, 3>(0, 3 * a) = g[0] * first.transpose();
    strain.block<1, 3>(1, 3 * a) = g[1] * second.transpose();
    strain.block<1, 3>(2, 3 * a) = g[1] * first.transpose() + g[0] * second.transpose();
  }
  return strain;
}

}  // namespace

PrincipalStress principal_stress(double s11, double s22, double s12) {
  const double middle = (s11 + s22) / 2, radius = std::hypot((s11 - s22) / 2, s12);
  return {middle + radius, middle - radius};
}

Eigen::Matrix3d plane_stress_law(const Law& law, const Eigen::Matrix3d& frame) {
  Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();
  if (!law.stiffness_pa) {
    const double nu = law.elastic.poisson_ratio, factor = law.elastic.youngs_modulus_pa / (1 - nu * nu);
    plane.topLeftCorner<2, 2>() << factor, nu * factor, nu * factor, factor;
    plane(2, 2) = law.elastic.mu_pa();
    return plane;
  }
  const Matrix6 c = rotated(*law.stiffness_pa, frame.transpose());
  constexpr std::array<int, 3> kInPlane = {0, 1, 5}, kAcross = {2, 3, 4};
  const Eigen::Matrix3d across = c(kAcross, kAcross), mixed = c(kAcross, kInPlane);
  plane = c(kInPlane, kInPlane);
  return plane - mixed.transpose() * dense::solve_symmetric(across, mixed);
}

SurfaceStress surface_stress(const mesh::TetMesh& mesh, const Solid& solid,
                             const Eigen::Ref<const Eigen::MatrixXd>& shapes, Eigen::Index points) {
  assert(shapes.rows() == 3 * mesh.nodes.rows() && points >= 1);
  const BlasThreads one(1);
  const mesh::FacePoints candidates = mesh::face_points(mesh);
  std::array<mesh::FaceFunctions, 4> functions;
  for (int f = 0; f < 4; ++f) functions[f] = mesh::face_functions(mesh.order(), f);
  const std::vector<Eigen::Index> chosen = spread_points(candidates.positions, points);
  std::vector<Eigen::Index> place_of(candidates.positions.rows(), -1);
  const auto count = static_cast<Eigen::Index>(chosen.size());
  for (Eigen::Index i = 0; i < count; ++i) place_of[chosen[i]] = i;

  const Eigen::Index modes = shapes.cols(), nodes = candidates.nodes.cols();
  SurfaceStress found{.positions = candidates.positions(chosen, Eigen::all),
                      .normals = candidates.normals(chosen, Eigen::all),
                      .first = mesh::Points(count, 3),
                      .second = mesh::Points(count, 3),
                      .components = Eigen::MatrixXd(3 * count, modes),
                      .largest = Eigen::VectorXd::Zero(modes)};
  Eigen::MatrixXd values(3 * nodes, modes), to_stress(3 * kPointsPerFace, 3 * nodes), stress(3 * kPointsPerFace, modes);
  for (Eigen::Index f = 0; f < candidates.nodes.rows(); ++f) {
    const mesh::FaceFunctions& on_face = functions[candidates.opposite[f]];
    const Law& law = solid.at(candidates.elements[f]);
    for (Eigen::Index a = 0; a < nodes; ++a)
      values.middleRows<3>(3 * a) = shapes.middleRows<3>(3 * Eigen::Index{candidates.nodes(f, a)});
    for (Eigen::Index i = 0; i < kPointsPerFace; ++i) {
      const Eigen::Index p = f * kPointsPerFace + i;
      const Eigen::Matrix3d frame = frame_at(candidates, p);
      Eigen::MatrixXd sides(nodes, 2);
      sides << on_face.along_second.row(i).transpose(), on_face.along_third.row(i).transpose();
      const Eigen::Matrix3d plane = plane_stress_law(law, frame);
      to_stress.middleRows<3>(3 * i) = plane * strain_of_nodes(candidates, p, frame, sides);
      if (place_of[p] < 0) continue;
      found.first.row(place_of[p]) = frame.col(0).transpose();
      found.second.row(place_of[p]) = frame.col(1).transpose();
    }
    dense::set_product(stress, to_stress, values);
    for (Eigen::Index i = 0; i < kPointsPerFace; ++i) {
      const Eigen::Index place = place_of[f * kPointsPerFace + i];
      if (place >= 0) found.components.middleRows<3>(3 * place) = stress.middleRows<3>(3 * i);
      for (Eigen::Index m = 0; m < modes; ++m) {
        const auto [larger, smaller] = principal_stress(stress(3 * i, m), stress(3 * i + 1, m), stress(3 * i + 2, m));
        found.largest[m] = std::max({found.largest[m], larger, -smaller});
      }
    }
  }
  return found;
}

}  // namespace ringdown::fem
