#include "engine/fem/quadratic_strain.h"

#include "engine/base/in_parallel.h"

#include <Eigen/LU>

#include <algorithm>

// Element by element, all points of the rule at once: the gradients of the shape functions stand in one matrix of three
// rows for each point, so that products with nodal values are products of matrices. A strain or stress of a point is
// its 3 x 3 matrix, kept as three rows. The rule is exact for the products in straight elements: E2 has the degree
// 2 (p - 1) in space, and is multiplied with another.
namespace ringdown::fem {
namespace {

constexpr int kMostThreads = 4;             // each has a copy of the shapes' size
constexpr Eigen::Index kFewElements = 200;  // for a thread

}  // namespace

struct QuadraticStrain::Element {
  Eigen::MatrixXd gradients;  // 3 points x n
  Eigen::VectorXd weights;    // of each point [m^3]
};

QuadraticStrain::QuadraticStrain(const mesh::TetMesh& mesh, const Elastic& elastic, const Eigen::MatrixXd& shapes,
                                 int threads)
    : mesh_(mesh),
      elastic_(elastic),
      threads_(std::clamp(static_cast<int>(mesh.elements.rows() / kFewElements), 1,
                          std::min(thread_count(threads), kMostThreads))),
      modes_(shapes.cols()),
      shapes_(shapes) {
  const int order = mesh.order();
  for (const mesh::QuadraturePoint& point : mesh::tet_quadrature(std::max(4 * (order - 1), 1))) {
    gradients_.push_back(mesh::interpolation_gradient(order, point.barycentric));
    weights_.push_back(point.weight);
  }
}

QuadraticStrain::Element QuadraticStrain::element(Eigen::Index number) const {
  const mesh::ElementNodes nodes = mesh::nodes_of(mesh_, number);
  const bool straight = mesh::is_straight(nodes);
  const auto points = static_cast<Eigen::Index>(weights_.size());
  Element here{Eigen::MatrixXd(3 * points, nodes.rows()), Eigen::VectorXd(points)};
  Eigen::Matrix3d inverse;
  double volume = 0;
  for (Eigen::Index q = 0; q < points; ++q) {
    if (q == 0 || !straight) {
      const Eigen::Matrix3d jacobian = mesh::jacobian(nodes, gradients_[q]);
      inverse = jacobian.inverse();
      volume = jacobian.determinant() / 6;
    }
    here.gradients.middleRows<3>(3 * q).noalias() = inverse * gradients_[q].transpose();
    here.weights[q] = weights_[q] * volume;
  }
  return here;
}

// The rows of an element's nodes, component by component: row a, columns c M .. (c + 1) M - 1.
void QuadraticStrain::gather(const Rows& from, Eigen::Index element, Rows& to) const {
  const Eigen::Index n = mesh_.elements.cols();
  to.resize(n, 3 * modes_);
  for (Eigen::Index a = 0; a < n; ++a) {
    std::copy_n(from.data() + 3 * modes_ * mesh_.elements(element, a), 3 * modes_, to.data() + 3 * modes_ * a);
  }
}

// E2 at each point from the element's nodal values and those of the shapes times the mixture.
Eigen::MatrixXd QuadraticStrain::strains(const Element& here, const Rows& own, const Rows& mixed) const {
  const Eigen::MatrixXd pairs = own * mixed.transpose();
  const Eigen::MatrixXd at = here.gradients * pairs;
  Eigen::MatrixXd result(here.gradients.rows(), 3);
  for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
    const Eigen::Matrix3d e2 = 0.5 * at.middleRows<3>(3 * q) * here.gradients.middleRows<3>(3 * q).transpose();
    result.middleRows<3>(3 * q) = 0.5 * (e2 + e2.transpose());
  }
  return result;
}

// Turns strains into stresses times the weight of their point.
void QuadraticStrain::stresses(Eigen::MatrixXd& strains, const Element& here) const {
  for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
    Eigen::Matrix3d stress = 2 * elastic_.mu_pa() * strains.middleRows<3>(3 * q);
    stress.diagonal().array() += elastic_.lambda_pa() * strains.middleRows<3>(3 * q).trace();
    strains.middleRows<3>(3 * q) = here.weights[q] * stress;
  }
}

void QuadraticStrain::for_elements(const std::function<void(int, Eigen::Index)>& work) const {
  in_parallel(threads_, [&](int thread) {
    const Eigen::Index count = mesh_.elements.rows();
    for (Eigen::Index e = count * thread / threads_; e < count * (thread + 1) / threads_; ++e) work(thread, e);
  });
}

Eigen::VectorXd QuadraticStrain::force(const Eigen::MatrixXd& mixture) const {
  const Rows mixed = shapes_ * mixture;
  std::vector<Eigen::VectorXd> forces(threads_, Eigen::VectorXd::Zero(shapes_.rows()));
  std::vector<Rows> own(threads_), other(threads_);
  for_elements([&](int thread, Eigen::Index e) {
    const Element here = element(e);
    gather(shapes_, e, own[thread]);
    gather(mixed, e, other[thread]);
    Eigen::MatrixXd stress = strains(here, own[thread], other[thread]);
    stresses(stress, here);
    const Eigen::MatrixXd at_nodes = here.gradients.transpose() * stress;
    for (Eigen::Index a = 0; a < at_nodes.rows(); ++a) {
      forces[thread].segment<3>(3 * mesh_.elements(e, a)) += at_nodes.row(a).transpose();
    }
  });
  for (int thread = 1; thread < threads_; ++thread) forces[0] += forces[thread];
  return std::move(forces[0]);
}

Eigen::MatrixXd QuadraticStrain::products(const Eigen::MatrixXd& mixture, const Eigen::VectorXd& u) const {
  const Rows mixed = shapes_ * mixture;
  const Eigen::Index n = mesh_.elements.cols();
  std::vector<Rows> sums(threads_, Rows::Zero(shapes_.rows(), modes_)), own(threads_), other(threads_);
  for_elements([&](int thread, Eigen::Index e) {
    const Element here = element(e);
    gather(shapes_, e, own[thread]);
    gather(mixed, e, other[thread]);
    Eigen::MatrixXd stress = strains(here, own[thread], other[thread]);
    Eigen::MatrixXd moved(n, 3);
    for (Eigen::Index a = 0; a < n; ++a) moved.row(a) = u.segment<3>(3 * mesh_.elements(e, a)).transpose();
    const Eigen::MatrixXd slopes = here.gradients * moved;
    for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
      const Eigen::Matrix3d slope = slopes.middleRows<3>(3 * q);
      stress.middleRows<3>(3 * q) -= 0.5 * (slope + slope.transpose());
    }
    stresses(stress, here);
    Eigen::MatrixXd pulled(here.gradients.rows(), n);
    for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
      pulled.middleRows<3>(3 * q).noalias() = stress.middleRows<3>(3 * q) * here.gradients.middleRows<3>(3 * q);
    }
    const Rows stiffness = here.gradients.transpose() * pulled;
    const Rows moments = stiffness * own[thread];
    for (Eigen::Index a = 0; a < n; ++a) {
      Eigen::Map<Eigen::VectorXd>(sums[thread].data() + 3 * modes_ * mesh_.elements(e, a), 3 * modes_) +=
          moments.row(a).transpose();
    }
  });
  for (int thread = 1; thread < threads_; ++thread) sums[0] += sums[thread];
  const Eigen::MatrixXd products = 0.5 * shapes_.transpose() * sums[0];
  return 0.5 * (products + products.transpose());
}

Eigen::VectorXd QuadraticStrain::carried_force(Eigen::Index mode) const {
  std::vector<Eigen::VectorXd> forces(threads_, Eigen::VectorXd::Zero(shapes_.rows()));
  for_elements([&](int thread, Eigen::Index e) {
    const Element here = element(e);
    Eigen::MatrixXd moved(mesh_.elements.cols(), 3);
    for (Eigen::Index a = 0; a < moved.rows(); ++a) {
      for (int i = 0; i < 3; ++i) moved(a, i) = shapes_(3 * mesh_.elements(e, a) + i, mode);
    }
    const Eigen::MatrixXd slopes = here.gradients * moved;  // row j of a point: d phi / dx_j
    Eigen::MatrixXd stress(slopes.rows(), 3);
    for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
      const Eigen::Matrix3d slope = slopes.middleRows<3>(3 * q);
      stress.middleRows<3>(3 * q) = 0.5 * (slope + slope.transpose());
    }
    stresses(stress, here);
    for (Eigen::Index q = 0; q < here.weights.size(); ++q) {
      const Eigen::Matrix3d carried = stress.middleRows<3>(3 * q) * slopes.middleRows<3>(3 * q);
      stress.middleRows<3>(3 * q) = carried;
    }
    const Eigen::MatrixXd at_nodes = here.gradients.transpose() * stress;
    for (Eigen::Index a = 0; a < at_nodes.rows(); ++a) {
      forces[thread].segment<3>(3 * mesh_.elements(e, a)) += at_nodes.row(a).transpose();
    }
  });
  for (int thread = 1; thread < threads_; ++thread) forces[0] += forces[thread];
  return std::move(forces[0]);
}

}  // namespace ringdown::fem
