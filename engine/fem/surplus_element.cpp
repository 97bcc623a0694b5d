#include "engine/fem/surplus_element.h"

#include "engine/mesh/surplus_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace ringdown::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

// See error_estimate.cpp, where this and softened() are explained.
constexpr double kRelaxed = 0.8;

constexpr double kLocked = 60;  // lambda / mu at nu = 0.492

double softened(double lambda, double mu) {
  return lambda > mu ? mu * std::pow(std::min(lambda / mu, kLocked), 0.75) : lambda;
}

// K from the products of gradients, for the functions from `row` and from `column` on.
MatrixXd stiffness(const MatrixXd& products, double lambda, double mu, int row, int rows, int column, int columns) {
  const Eigen::Index all = products.rows() / 3;
  const auto product = [&](int k, int l) { return products.block(k * all + row, l * all + column, rows, columns); };
  const MatrixXd trace = product(0, 0) + product(1, 1) + product(2, 2);
  MatrixXd result(3 * rows, 3 * columns);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      auto block = result.block(i * rows, j * columns, rows, columns);
      block = lambda * product(i, j) + mu * product(j, i);
      if (i == j) block += mu * trace;
    }
  }
  return result;
}

// The six rigid motions at the nodes, columns of length 1.
MatrixXd rigid_motions(const mesh::ElementNodes& nodes) {
  const Eigen::Index n = nodes.rows();
  const Eigen::Matrix<double, Eigen::Dynamic, 3> arm = nodes.rowwise() - nodes.colwise().mean();
  MatrixXd motions = MatrixXd::Zero(3 * n, 6);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    motions.col(i).segment(i * n, n).setOnes();
    motions.col(3 + i).segment(j * n, n) = -arm.col(k);
    motions.col(3 + i).segment(k * n, n) = arm.col(j);
  }
  motions.colwise().normalize();
  return motions;
}

}  // namespace

SurplusElement::SurplusElement(int order, const Elastic& elastic)
    : w_(mesh::surplus_per_element(order)), n_(mesh::nodes_per_element(order)), elastic_(elastic) {
  const std::vector<mesh::QuadraturePoint> rule = mesh::tet_quadrature(2 * order + 1);
  const auto points = static_cast<Eigen::Index>(rule.size());
  const int all = w_ + n_;
  weights_.resize(points);
  surplus_.resize(w_, points);
  shapes_.resize(n_, points);
  straight_products_ = MatrixXd::Zero(3 * all, 3 * all);
  for (Eigen::Index q = 0; q < points; ++q) {
    const Eigen::Vector4d& at = rule[q].barycentric;
    weights_[q] = rule[q].weight / 6;
    surplus_.col(q) = mesh::surplus_shape(order, at);
    shapes_.col(q) = mesh::shape(order, at);
    gradients_.emplace_back(all, 3);
    gradients_.back() << mesh::surplus_gradient(order, at), mesh::reference_gradient(order, at);
    straight_products_ += weights_[q] * gradients_.back().reshaped() * gradients_.back().reshaped().transpose();
  }
  straight_mass_ = surplus_ * weights_.asDiagonal() * shapes_.transpose();
}

MatrixXd SurplusElement::gradient_products(const mesh::ElementNodes& nodes, MatrixXd& mass) const {
  const int all = w_ + n_;
  if (mesh::is_straight(nodes)) {
    const Matrix3d jacobian = mesh::jacobian(mesh::Corners(nodes.topRows<4>())), inverse = jacobian.inverse();
    const double volume = std::abs(jacobian.determinant());
    mass = volume * straight_mass_;
    MatrixXd half = MatrixXd::Zero(3 * all, 3 * all), products = half;
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) {
        half.middleCols(k * all, all) += volume * inverse(k, m) * straight_products_.middleCols(m * all, all);
      }
    }
    for (int k = 0; k < 3; ++k) {
      for (int m = 0; m < 3; ++m) products.middleRows(k * all, all) += inverse(k, m) * half.middleRows(m * all, all);
    }
    return products;
  }
  MatrixXd gradients(3 * all, weights_.size());
  Eigen::VectorXd volumes(weights_.size());
  for (Eigen::Index q = 0; q < weights_.size(); ++q) {
    const Matrix3d jacobian = mesh::jacobian(nodes, gradients_[q].bottomRows(n_));
    volumes[q] = weights_[q] * std::abs(jacobian.determinant());
    gradients.col(q).reshaped(all, 3) = gradients_[q] * jacobian.inverse().transpose();
  }
  mass = surplus_ * volumes.asDiagonal() * shapes_.transpose();
  const MatrixXd weighted = gradients * volumes.asDiagonal();
  return weighted * gradients.transpose();
}

Eigen::MatrixXf SurplusElement::relaxed(const MatrixXd& products, const mesh::ElementNodes& nodes) const {
  const double mu = elastic_.mu_pa(), lambda = softened(elastic_.lambda_pa(), mu);
  MatrixXd energy = stiffness(products, lambda, mu, 0, w_, 0, w_);
  MatrixXd lower = stiffness(products, lambda, mu, w_, n_, w_, n_);
  const MatrixXd rigid = rigid_motions(nodes);
  lower += lower.diagonal().mean() * rigid * rigid.transpose();  // K is singular there, and W meets none of it
  const Eigen::LLT<MatrixXd> factors(lower);
  if (factors.info() == Eigen::Success) {
    const MatrixXd half = factors.matrixL().solve(stiffness(products, lambda, mu, w_, n_, 0, w_));
    energy -= kRelaxed * half.transpose() * half;
  }
  return energy.cast<float>();
}

SurplusMatrices SurplusElement::operator()(const mesh::ElementNodes& nodes) const {
  SurplusMatrices element;
  const MatrixXd products = gradient_products(nodes, element.mass);
  element.mass *= elastic_.density_kg_m3;
  element.coupling = stiffness(products, elastic_.lambda_pa(), elastic_.mu_pa(), 0, w_, w_, n_);
  element.energy = relaxed(products, nodes);
  return element;
}

}  // namespace ringdown::fem
