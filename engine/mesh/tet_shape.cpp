#include "engine/mesh/tet_shape.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cassert>

namespace ringdown::mesh {
namespace {

struct LineRule {
  Eigen::VectorXd points;   // in (0, 1)
  Eigen::VectorXd weights;  // sum to 1
};

// Gauss rule for the weight (1-t)^power on (0, 1), by the eigenvalues of the Jacobi matrix (Golub & Welsch
// 1969). The recurrence is that of the Jacobi polynomials with exponents (power, 0) on (-1, 1), mapped to (0,
// 1).
LineRule gauss_jacobi(int count, int power) {
  const double a = power;
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(count, count);
  for (int n = 0; n < count; ++n) {
    const double s = 2 * n + a;
    jacobi(n, n) = n == 0 ? -a / (a + 2) : -a * a / (s * (s + 2));
    if (n > 0) {
      const double square = 4.0 * n * n * (n + a) * (n + a) / (s * s * (s * s - 1));
      jacobi(n, n - 1) = jacobi(n - 1, n) = std::sqrt(square);
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solved(jacobi);
  return {(0.5 * (1 + solved.eigenvalues().array())).matrix(), solved.eigenvectors().row(0).array().square().matrix()};
}

std::vector<QuadraturePoint> conical_product(int count) {
  const LineRule first = gauss_jacobi(count, 2), second = gauss_jacobi(count, 1), third = gauss_jacobi(count, 0);
  std::vector<QuadraturePoint> rule;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      for (int k = 0; k < count; ++k) {
        const double l1 = first.points[i];
        const double l2 = (1 - l1) * second.points[j];
        const double l3 = (1 - l1 - l2) * third.points[k];
        rule.push_back({{1 - l1 - l2 - l3, l1, l2, l3}, first.weights[i] * second.weights[j] * third.weights[k]});
      }
    }
  }
  return rule;
}

}  // namespace

Eigen::Matrix3d jacobian(const Corners& corners) { return corners.bottomRows<3>().rowwise() - corners.row(0); }

Eigen::Matrix3d jacobian(const ElementNodes& nodes, const ReferenceGradient& reference_gradient) {
  return reference_gradient.transpose().lazyProduct(nodes);
}

ElementNodes straight_nodes(int order, const Corners& corners) {
  static const std::array<Lattice, kMaxOrder> lattices = {lattice(1), lattice(2), lattice(3), lattice(4)};
  return lattices[order - 1].lazyProduct(corners);
}

bool is_straight(const ElementNodes& nodes) {
  const Corners corners = nodes.topRows<4>();
  double longest = 0;
  for (const auto& [i, j] : kTetEdges) longest = std::max(longest, (corners.row(i) - corners.row(j)).norm());
  const ElementNodes straight = straight_nodes(order_of_nodes(nodes.rows()), corners);
  return (nodes - straight).rowwise().squaredNorm().maxCoeff() <= 1e-18 * longest * longest;
}

std::vector<QuadraturePoint> tet_quadrature(int degree) {
  assert(degree >= 0 && degree <= 20);
  if (degree <= 1) return {{Eigen::Vector4d::Constant(0.25), 1.0}};
  if (degree > 2) return conical_product((degree + 2) / 2);
  const double near = (5 + 3 * std::sqrt(5.0)) / 20, far = (5 - std::sqrt(5.0)) / 20;
  std::vector<QuadraturePoint> rule(4, {Eigen::Vector4d::Constant(far), 0.25});
  for (int i = 0; i < 4; ++i) rule[i].barycentric[i] = near;
  return rule;
}

}  // namespace ringdown::mesh
