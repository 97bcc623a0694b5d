#include "engine/fem/surface_stress.h"

#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
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

// Returns numbers of points, at most `count`: first those in `wanted`, then each the farthest from all before it.
std::vector<Eigen::Index> spread_points(const mesh::Points& positions, const std::vector<Eigen::Index>& wanted,
                                        Eigen::Index count) {
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(positions.rows(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::Index> chosen;
  const auto choose = [&](Eigen::Index point) {
    chosen.push_back(point);
    const Eigen::RowVector3d place = positions.row(point);
    for (Eigen::Index p = 0; p < positions.rows(); ++p)
      distance[p] = std::min(distance[p], (positions.row(p) - place).squaredNorm());
  };
  for (const Eigen::Index point : wanted) {
    if (distance[point] > 0) choose(point);
  }
  Eigen::Index farthest = 0;
  if (chosen.empty()) {
    const Eigen::RowVector3d middle = positions.colwise().mean();
    (positions.rowwise() - middle).rowwise().squaredNorm().maxCoeff(&farthest);
    choose(farthest);
  }
  while (static_cast<Eigen::Index>(chosen.size()) < count && distance.maxCoeff(&farthest) > 0) choose(farthest);
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

// Computes the stress of all shapes at the points of one face after another.
class FaceStress {
 public:
  FaceStress(int order, const Solid& solid, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
             const mesh::FacePoints& points)
      : solid_(solid),
        shapes_(shapes),
        points_(points),
        values_(3 * points.nodes.cols(), shapes.cols()),
        to_stress_(3 * kPointsPerFace, 3 * points.nodes.cols()),
        stress_(3 * kPointsPerFace, shapes.cols()) {
    for (int f = 0; f < 4; ++f) functions_[f] = mesh::face_functions(order, f);
  }

  // Returns s11, s22 and s12 at each point of face f, 3 kPointsPerFace x m.
  const Eigen::MatrixXd& at(Eigen::Index f) {
    const Eigen::Index nodes = points_.nodes.cols();
    const mesh::FaceFunctions& functions = functions_[points_.opposite[f]];
    for (Eigen::Index a = 0; a < nodes; ++a)
      values_.middleRows<3>(3 * a) = shapes_.middleRows<3>(3 * Eigen::Index{points_.nodes(f, a)});
    Eigen::MatrixXd sides(nodes, 2);
    for (Eigen::Index i = 0; i < kPointsPerFace; ++i) {
      const Eigen::Index p = f * kPointsPerFace + i;
      const Eigen::Matrix3d frame = frame_at(points_, p);
      sides << functions.along_second.row(i).transpose(), functions.along_third.row(i).transpose();
      to_stress_.middleRows<3>(3 * i) =
          plane_stress_law(solid_.at(points_.elements[f]), frame) * strain_of_nodes(points_, p, frame, sides);
    }
    dense::set_product(stress_, to_stress_, values_);
    return stress_;
  }

 private:
  const Solid& solid_;
  const Eigen::Ref<const Eigen::MatrixXd> shapes_;
  const mesh::FacePoints& points_;
  std::array<mesh::FaceFunctions, 4> functions_;
  Eigen::MatrixXd values_, to_stress_, stress_;
};

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
  const dense::BlasThreads one(1);
  const mesh::FacePoints candidates = mesh::face_points(mesh);
  FaceStress on_face(mesh.order(), solid, shapes, candidates);
  const Eigen::Index modes = shapes.cols(), faces = candidates.nodes.rows();
  SurfaceStress found{.largest = Eigen::VectorXd::Zero(modes)};
  std::vector<Eigen::Index> peaks(modes, -1);
  for (Eigen::Index f = 0; f < faces; ++f) {
    const Eigen::MatrixXd& stress = on_face.at(f);
    for (Eigen::Index m = 0; m < modes; ++m) {
      for (Eigen::Index i = 0; i < kPointsPerFace; ++i) {
        const auto [larger, smaller] = principal_stress(stress(3 * i, m), stress(3 * i + 1, m), stress(3 * i + 2, m));
        if (std::max(larger, -smaller) <= found.largest[m]) continue;
        found.largest[m] = std::max(larger, -smaller);
        peaks[m] = f * kPointsPerFace + i;
      }
    }
  }
  std::erase(peaks, -1);
  peaks.resize(std::min(peaks.size(), static_cast<std::size_t>(points / 2)));
  std::vector<Eigen::Index> chosen = spread_points(candidates.positions, peaks, points);
  std::sort(chosen.begin(), chosen.end());

  const auto count = static_cast<Eigen::Index>(chosen.size());
  found.positions = candidates.positions(chosen, Eigen::all);
  found.normals = candidates.normals(chosen, Eigen::all);
  found.first.resize(count, 3);
  found.second.resize(count, 3);
  found.components.resize(3 * count, modes);
  for (Eigen::Index p = 0; p < count; ++p) {
    const Eigen::Matrix3d frame = frame_at(candidates, chosen[p]);
    found.first.row(p) = frame.col(0).transpose();
    found.second.row(p) = frame.col(1).transpose();
    found.components.middleRows<3>(3 * p) =
        on_face.at(chosen[p] / kPointsPerFace).middleRows<3>(3 * (chosen[p] % kPointsPerFace));
  }
  return found;
}

}  // namespace ringdown::fem
