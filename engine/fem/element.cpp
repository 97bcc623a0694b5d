#include "engine/fem/element.h"

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <vector>

namespace ringdown::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using mesh::QuadraturePoint;

// Shape functions and their reference gradients at the points of a rule.
struct Samples {
  Samples(int order, int degree) {
    const std::vector<QuadraturePoint> rule = mesh::tet_quadrature(degree);
    const auto count = static_cast<Eigen::Index>(rule.size());
    weights.resize(count);
    shapes.resize(mesh::nodes_per_element(order), count);
    gradients.resize(3 * count, shapes.rows());
    for (Eigen::Index q = 0; q < count; ++q) {
      weights[q] = rule[q].weight;
      shapes.col(q) = mesh::interpolation(order, rule[q].barycentric);
      gradients.middleRows<3>(3 * q) = mesh::interpolation_gradient(order, rule[q].barycentric).transpose();
    }
  }
  [[nodiscard]] Eigen::Index count() const { return weights.size(); }

  Eigen::VectorXd weights;
  MatrixXd shapes;     // n x count
  MatrixXd gradients;  // three rows for each point: 3 count x n
};

// A Reference holds what all elements of one order share, computed once. In a straight element the products of
// gradients have the degree 2 p - 2 and those of shape functions 2 p, and the rules are exact. In a curved element the
// mass has the degree 5 p - 3, since the determinant adds 3 (p - 1), and its rule is exact, too; the stiffness is not
// polynomial there, because the inverse of the Jacobian is in it, and its rule is exact for 2 p + 1.
struct Reference {
  explicit Reference(int order)
      : stiffness_rule(order, 2 * order + 1), mass_rule(order, 5 * order - 3), mass(shape_products(order)) {
    const Samples rule(order, 2 * order - 2);
    gradients = MatrixXd::Zero(3 * rule.shapes.rows(), 3 * rule.shapes.rows());
    for (Eigen::Index q = 0; q < rule.count(); ++q) {
      const MatrixXd at = rule.gradients.middleRows<3>(3 * q);
      gradients += rule.weights[q] * at.reshaped() * at.reshaped().transpose();
    }
  }

  static MatrixXd shape_products(int order) {
    const Samples rule(order, 2 * order);
    return rule.shapes * rule.weights.asDiagonal() * rule.shapes.transpose();
  }

  Samples stiffness_rule, mass_rule;  // for curved elements
  MatrixXd mass;                      // n x n, mean of N_a N_b over the element
  MatrixXd gradients;                 // 3n x 3n, mean of ghat_a ghat_b^T
};

const Reference& reference(int order) {
  static const std::array<Reference, mesh::kMaxOrder> all = {Reference(1), Reference(2), Reference(3), Reference(4)};
  return all[order - 1];
}

double volume(const mesh::Corners& corners) { return mesh::jacobian(corners).determinant() / 6; }

// Computes the products G of a straight element: the blocks on and below the diagonal.
void straight_gradients(const mesh::Corners& corners, const MatrixXd& reference_gradients, MatrixXd& gradients) {
  const Matrix3d inverse = mesh::jacobian(corners).inverse(), scaled = volume(corners) * inverse;
  for (Eigen::Index b = 0; b < gradients.cols(); b += 3) {
    for (Eigen::Index a = b; a < gradients.rows(); a += 3) {
      const Matrix3d block = reference_gradients.block<3, 3>(a, b);
      gradients.block<3, 3>(a, b) = scaled * block * inverse.transpose();
    }
  }
}

// Computes the stiffness K from the products of gradients, block by block (element.h).
void elastic_stiffness(const MatrixXd& gradients, const Elastic& elastic, Eigen::Ref<MatrixXd> stiffness) {
  const double lambda = elastic.lambda_pa(), mu = elastic.mu_pa();
  for (Eigen::Index b = 0; b < gradients.cols(); b += 3) {
    for (Eigen::Index a = b; a < gradients.rows(); a += 3) {
      Matrix3d block = gradients.block<3, 3>(a, b);
      if (a == b) block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
      Matrix3d sum = lambda * block + mu * block.transpose();
      sum.diagonal().array() += mu * block.trace();
      stiffness.block<3, 3>(a, b) = sum;
      stiffness.block<3, 3>(b, a) = sum.transpose();
    }
  }
}

void anisotropic_stiffness(const MatrixXd& gradients, const Matrix6& law, Eigen::Ref<MatrixXd> stiffness) {
  const GradientToStiffness blocks = gradient_to_stiffness(law);
  for (Eigen::Index b = 0; b < gradients.cols(); b += 3) {
    for (Eigen::Index a = b; a < gradients.rows(); a += 3) {
      Matrix3d block = gradients.block<3, 3>(a, b);
      if (a == b) block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
      Matrix3d sum;
      sum.reshaped() = blocks * block.reshaped();
      stiffness.block<3, 3>(a, b) = sum;
      stiffness.block<3, 3>(b, a) = sum.transpose();
    }
  }
}

}  // namespace

ElementIntegrals::ElementIntegrals(int order) : order_(order) {
  const Eigen::Index nodes = mesh::nodes_per_element(order), points = reference(order).mass_rule.count();
  gradients_.resize(3 * nodes, 3 * nodes);
  samples_.resize(3 * nodes, points);
  jacobians_.resize(3 * points, 3);
}

void ElementIntegrals::operator()(const mesh::ElementNodes& nodes, const Law& law, Eigen::Ref<MatrixXd> stiffness,
                                  Eigen::Ref<MatrixXd> mass) {
  const double density = law.elastic.density_kg_m3;
  if (mesh::is_straight(nodes)) {
    const mesh::Corners corners = nodes.topRows<4>();
    straight_gradients(corners, reference(order_).gradients, gradients_);
    mass = density * volume(corners) * reference(order_).mass;
  } else {
    integrate_curved(nodes, density, mass);
  }
  if (law.stiffness_pa) return anisotropic_stiffness(gradients_, *law.stiffness_pa, stiffness);
  elastic_stiffness(gradients_, law.elastic, stiffness);
}

// Each sum over the points q of a rule is computed as the product of a matrix, whose columns are the samples times
// sqrt(weight), with its own transpose. BLAS is fastest at such products.
void ElementIntegrals::integrate_curved(const mesh::ElementNodes& nodes, double density_kg_m3,
                                        Eigen::Ref<MatrixXd> mass) {
  const Samples& for_stiffness = reference(order_).stiffness_rule;
  const auto jacobian_at = [&](Eigen::Index q) -> Matrix3d { return jacobians_.middleRows<3>(3 * q); };
  auto slopes = samples_.leftCols(for_stiffness.count());
  jacobians_.topRows(3 * for_stiffness.count()).noalias() = for_stiffness.gradients * nodes;
  for (Eigen::Index q = 0; q < for_stiffness.count(); ++q) {
    const Matrix3d jacobian = jacobian_at(q);
    const Matrix3d to_space = std::sqrt(for_stiffness.weights[q] * jacobian.determinant() / 6) * jacobian.inverse();
    slopes.col(q).reshaped(3, nodes.rows()) = to_space.lazyProduct(for_stiffness.gradients.middleRows<3>(3 * q));
  }
  gradients_.setZero();
  gradients_.selfadjointView<Eigen::Lower>().rankUpdate(slopes);

  const Samples& for_mass = reference(order_).mass_rule;
  auto shapes = samples_.topLeftCorner(nodes.rows(), for_mass.count());
  jacobians_.noalias() = for_mass.gradients * nodes;
  for (Eigen::Index q = 0; q < for_mass.count(); ++q) {
    const double volume = jacobian_at(q).determinant() / 6;
    shapes.col(q) = std::sqrt(density_kg_m3 * for_mass.weights[q] * volume) * for_mass.shapes.col(q);
  }
  mass.setZero();
  mass.selfadjointView<Eigen::Lower>().rankUpdate(shapes);
  mass.triangularView<Eigen::StrictlyUpper>() = mass.transpose();
}

MatrixXd stiffness(const mesh::ElementNodes& nodes, const Elastic& elastic) {
  MatrixXd stiffness(3 * nodes.rows(), 3 * nodes.rows()), mass(nodes.rows(), nodes.rows());
  ElementIntegrals(mesh::order_of_nodes(nodes.rows()))(nodes, {elastic}, stiffness, mass);
  return stiffness;
}

MatrixXd consistent_mass(const mesh::ElementNodes& nodes, double density_kg_m3) {
  MatrixXd stiffness(3 * nodes.rows(), 3 * nodes.rows()), mass(nodes.rows(), nodes.rows());
  ElementIntegrals(mesh::order_of_nodes(nodes.rows()))(nodes, {{1, 0, density_kg_m3}}, stiffness, mass);
  return mass;
}

Eigen::Matrix4d lumped_mass(const mesh::Corners& corners, double density_kg_m3) {
  return density_kg_m3 * volume(corners) / 4 * Eigen::Matrix4d::Identity();
}

}  // namespace ringdown::fem
