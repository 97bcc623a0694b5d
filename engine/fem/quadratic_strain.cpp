#include "engine/fem/quadratic_strain.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/products.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <utility>

// E2 is computed in the coordinates of the reference element. There it is one constant matrix, equal for all elements,
// times the lower triangle of P, so a batch of elements is one product of matrices. For the stress, each point's strain
// is transformed to the body's coordinates, E2 = J^-1 E2' J^-T. For the geometric stiffness the stress is transformed
// back; the stiffness is the transpose of the constant matrix times the stresses.
//
// The rule is exact, in straight elements, for the products of E2 (degree 2 (p - 1) in space) with linear strains
// (p - 1), that is for forces. Products of E2 with itself stay sums of squares, with an error of order 3 p - 2.
namespace ringdown::fem {
namespace {

constexpr int kMaxThreads = 4;              // each has memory of the shapes' size
constexpr Eigen::Index kFewElements = 200;  // at least, per thread
constexpr Eigen::Index kBatch = 16;

constexpr std::array<std::pair<int, int>, 6> kComponents = {{{0, 0}, {1, 1}, {2, 2}, {1, 0}, {2, 0}, {2, 1}}};

Eigen::Matrix3d symmetric(const double* components) {
  Eigen::Matrix3d result;
  for (std::size_t c = 0; c < kComponents.size(); ++c) {
    const auto [i, j] = kComponents[c];
    result(i, j) = result(j, i) = components[c];
  }
  return result;
}

}  // namespace

// The working memory of one thread: the fields of up to kBatch elements, side by side.
struct QuadraticStrain::Batch {
  std::vector<Rows> own = std::vector<Rows>(kBatch);  // each n x 3M: the shapes at an element's nodes
  Rows mixed;                                         // one element's `own` times the mixture
  Eigen::MatrixXd pairs, strains;                     // a column for each element: P, and E2' at each point
};

QuadraticStrain::QuadraticStrain(const mesh::TetMesh& mesh, const Elastic& elastic, const Eigen::MatrixXd& shapes,
                                 int threads)
    : mesh_(mesh),
      elastic_(elastic),
      threads_(std::clamp(static_cast<int>(mesh.elements.rows() / kFewElements), 1,
                          std::min(thread_count(threads), kMaxThreads))),
      modes_(shapes.cols()),
      shapes_(shapes),
      places_(mesh.elements.rows()) {
  const int order = mesh.order();
  const Eigen::Index n = mesh.elements.cols();
  const std::vector<mesh::QuadraturePoint> rule = mesh::tet_quadrature(std::max(3 * (order - 1), 1));
  const auto points = static_cast<Eigen::Index>(rule.size());
  std::vector<mesh::ReferenceGradient> gradients;
  gradients_.resize(3 * points, n);
  from_pairs_.resize(6 * points, n * (n + 1) / 2);
  for (Eigen::Index q = 0; q < points; ++q) {
    weights_.push_back(rule[q].weight);
    const mesh::ReferenceGradient& g = gradients.emplace_back(mesh::interpolation_gradient(order, rule[q].barycentric));
    gradients_.middleRows<3>(3 * q) = g.transpose();
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b, ++pair) {
        for (Eigen::Index c = 0; c < 6; ++c) {
          const auto [i, j] = kComponents[c];
          from_pairs_(6 * q + c, pair) = (a == b ? 0.25 : 0.5) * (g(a, i) * g(b, j) + g(b, i) * g(a, j));
        }
      }
    }
  }
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    const mesh::ElementNodes nodes = mesh::nodes_of(mesh, e);
    places_[e].resize(mesh::is_straight(nodes) ? 1 : points);
    for (std::size_t q = 0; q < places_[e].size(); ++q) {
      const Eigen::Matrix3d jacobian = mesh::jacobian(nodes, gradients[q]);
      places_[e][q] = {jacobian.inverse(), jacobian.determinant() / 6};
    }
  }
}

const QuadraticStrain::Place& QuadraticStrain::place(Eigen::Index element, std::size_t point) const {
  const std::vector<Place>& places = places_[element];
  return places[places.size() == 1 ? 0 : point];
}

Eigen::Matrix3d QuadraticStrain::weighted_stress(const Eigen::Matrix3d& strain, std::size_t point,
                                                 double volume) const {
  Eigen::Matrix3d stress = 2 * elastic_.mu_pa() * strain;
  stress.diagonal().array() += elastic_.lambda_pa() * strain.trace();
  return weights_[point] * volume * stress;
}

// Copies the rows of an element's nodes, component by component: row a, columns c M .. (c + 1) M - 1.
void QuadraticStrain::gather(const Rows& from, Eigen::Index element, Rows& to) const {
  const Eigen::Index n = mesh_.elements.cols();
  to.resize(n, 3 * modes_);
  for (Eigen::Index a = 0; a < n; ++a) {
    std::copy_n(from.data() + 3 * modes_ * mesh_.elements(element, a), 3 * modes_, to.data() + 3 * modes_ * a);
  }
}

void QuadraticStrain::load(const Rows& mixed, Eigen::Index first, Eigen::Index count, Batch& batch) const {
  const Eigen::Index n = mesh_.elements.cols();
  batch.pairs.resize(from_pairs_.cols(), count);
  for (Eigen::Index e = 0; e < count; ++e) {
    gather(shapes_, first + e, batch.own[e]);
    gather(mixed, first + e, batch.mixed);
    const Eigen::MatrixXd pairs = batch.own[e] * batch.mixed.transpose();
    Eigen::Index pair = 0;
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b <= a; ++b) batch.pairs(pair++, e) = pairs(b, a);
    }
  }
  batch.strains = dense::product(from_pairs_, batch.pairs);
}

// Returns three rows for each point: d u_k / d xi_j in row j.
Eigen::MatrixXd QuadraticStrain::reference_slopes(const Eigen::VectorXd& u, Eigen::Index element) const {
  Eigen::MatrixXd moved(mesh_.elements.cols(), 3);
  for (Eigen::Index a = 0; a < moved.rows(); ++a) {
    moved.row(a) = u.segment<3>(3 * mesh_.elements(element, a)).transpose();
  }
  return dense::product(gradients_, moved);
}

// `stresses` has three rows for each point: J^-T times the weighted stress.
void QuadraticStrain::add_force(const Eigen::MatrixXd& stresses, Eigen::Index element, Eigen::VectorXd& force) const {
  const Eigen::MatrixXd at_nodes = dense::transposed_product(gradients_, stresses);
  for (Eigen::Index a = 0; a < at_nodes.rows(); ++a) {
    force.segment<3>(3 * mesh_.elements(element, a)) += at_nodes.row(a).transpose();
  }
}

void QuadraticStrain::for_batches(const std::function<void(int, Eigen::Index, Eigen::Index)>& work) const {
  in_parallel(threads_, [&](int thread) {
    const Eigen::Index count = mesh_.elements.rows(), end = count * (thread + 1) / threads_;
    for (Eigen::Index e = count * thread / threads_; e < end; e += kBatch) work(thread, e, std::min(kBatch, end - e));
  });
}

Eigen::VectorXd QuadraticStrain::force(const Eigen::MatrixXd& mixture) const {
  const Rows mixed = shapes_ * mixture;
  std::vector<Eigen::VectorXd> forces(threads_, Eigen::VectorXd::Zero(shapes_.rows()));
  std::vector<Batch> batches(threads_);
  for_batches([&](int thread, Eigen::Index first, Eigen::Index count) {
    Batch& batch = batches[thread];
    load(mixed, first, count, batch);
    Eigen::MatrixXd stresses(gradients_.rows(), 3);
    for (Eigen::Index e = 0; e < count; ++e) {
      for (std::size_t q = 0; q < weights_.size(); ++q) {
        const auto& [inverse, volume] = place(first + e, q);
        const Eigen::Matrix3d strain = inverse * symmetric(&batch.strains(6 * q, e)) * inverse.transpose();
        stresses.middleRows<3>(3 * q) = inverse.transpose() * weighted_stress(strain, q, volume);
      }
      add_force(stresses, first + e, forces[thread]);
    }
  });
  for (int thread = 1; thread < threads_; ++thread) forces[0] += forces[thread];
  return std::move(forces[0]);
}

Eigen::MatrixXd QuadraticStrain::products(const Eigen::MatrixXd& mixture, const Eigen::VectorXd& u) const {
  const Rows mixed = shapes_ * mixture;
  const Eigen::Index n = mesh_.elements.cols();
  std::vector<Rows> sums(threads_, Rows::Zero(shapes_.rows(), modes_));
  std::vector<Batch> batches(threads_);
  for_batches([&](int thread, Eigen::Index first, Eigen::Index count) {
    Batch& batch = batches[thread];
    load(mixed, first, count, batch);
    for (Eigen::Index e = 0; e < count; ++e) {
      const Eigen::MatrixXd slopes = reference_slopes(u, first + e);
      for (std::size_t q = 0; q < weights_.size(); ++q) {
        const auto& [inverse, volume] = place(first + e, q);
        const Eigen::Matrix3d slope = inverse * slopes.middleRows<3>(3 * q);
        const Eigen::Matrix3d strain =
            inverse * symmetric(&batch.strains(6 * q, e)) * inverse.transpose() - 0.5 * (slope + slope.transpose());
        const Eigen::Matrix3d stress = inverse.transpose() * weighted_stress(strain, q, volume) * inverse;
        for (std::size_t c = 0; c < 6; ++c) {
          const auto [i, j] = kComponents[c];
          batch.strains(6 * q + c, e) = (i == j ? 1 : 2) * stress(i, j);
        }
      }
    }
    batch.pairs = dense::transposed_product(from_pairs_, batch.strains);  // stiffnesses, their diagonals halved
    Eigen::MatrixXd stiffness(n, n);
    for (Eigen::Index e = 0; e < count; ++e) {
      Eigen::Index pair = 0;
      for (Eigen::Index a = 0; a < n; ++a) {
        for (Eigen::Index b = 0; b <= a; ++b) stiffness(a, b) = stiffness(b, a) = batch.pairs(pair++, e);
        stiffness(a, a) *= 2;
      }
      const Rows moments = stiffness * batch.own[e];
      for (Eigen::Index a = 0; a < n; ++a) {
        Eigen::Map<Eigen::VectorXd>(sums[thread].data() + 3 * modes_ * mesh_.elements(first + e, a), 3 * modes_) +=
            moments.row(a).transpose();
      }
    }
  });
  for (int thread = 1; thread < threads_; ++thread) sums[0] += sums[thread];
  const Eigen::MatrixXd products = 0.5 * shapes_.transpose() * sums[0];
  return 0.5 * (products + products.transpose());
}

Eigen::VectorXd QuadraticStrain::carried_force(Eigen::Index mode) const {
  std::vector<Eigen::VectorXd> forces(threads_, Eigen::VectorXd::Zero(shapes_.rows()));
  const Eigen::VectorXd shape = shapes_.col(mode);
  for_batches([&](int thread, Eigen::Index first, Eigen::Index count) {
    for (Eigen::Index e = first; e < first + count; ++e) {
      Eigen::MatrixXd stresses = reference_slopes(shape, e);
      for (std::size_t q = 0; q < weights_.size(); ++q) {
        const auto& [inverse, volume] = place(e, q);
        const Eigen::Matrix3d slope = inverse * stresses.middleRows<3>(3 * q);  // row j: d phi / dx_j
        const Eigen::Matrix3d stress = weighted_stress(0.5 * (slope + slope.transpose()), q, volume);
        stresses.middleRows<3>(3 * q) = inverse.transpose() * stress * slope;
      }
      add_force(stresses, e, forces[thread]);
    }
  });
  for (int thread = 1; thread < threads_; ++thread) forces[0] += forces[thread];
  return std::move(forces[0]);
}

}  // namespace ringdown::fem
