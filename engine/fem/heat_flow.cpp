#include "engine/fem/heat_flow.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"
#include "engine/fem/blas_threads.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>
#include <vector>

namespace ringdown::fem {
namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// The derivatives of the heat equation's relaxation are fastest through the wall: the slowest of them is pi^2 / wall^2.
constexpr double kShift = 50;  // over wall^2; between the rates of the first and the third way through the wall
constexpr double kTolerance = 1e-8;

// The stress that holds back a relative expansion of 1 along all axes: xx, yy, zz, yz, xz, xy.
Eigen::Matrix<double, 6, 1> thermal_stress(const Law& law) {
  const Matrix6 stiffness = law.stiffness_pa ? *law.stiffness_pa : isotropic_stiffness(law.elastic);
  return stiffness.leftCols<3>().rowwise().sum();
}

// Shape functions and gradients of elements of one order at the points of a rule.
class Sampled {
 public:
  Sampled(int order, const std::vector<mesh::QuadraturePoint>& rule)
      : values(mesh::nodes_per_element(order), static_cast<Eigen::Index>(rule.size())) {
    for (std::size_t q = 0; q < rule.size(); ++q) {
      values.col(static_cast<Eigen::Index>(q)) = mesh::interpolation(order, rule[q].barycentric);
      gradients.push_back(mesh::interpolation_gradient(order, rule[q].barycentric));
    }
  }
  Eigen::MatrixXd values;                          // n x points
  std::vector<mesh::ReferenceGradient> gradients;  // of each point, n x 3
};

struct Rule {
  Rule(int order, int heat_order)
      : points(mesh::tet_quadrature(2 * heat_order)), moved(order, points), warmed(heat_order, points) {}
  std::vector<mesh::QuadraturePoint> points;
  Sampled moved, warmed;
};

// Solves for one column after the other.
class Solver {
 public:
  explicit Solver(const RowMatrix& matrix) {
    solver_.setTolerance(kTolerance);
    solver_.setMaxIterations(5000);
    solver_.compute(matrix);
  }
  [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& right) const { return solver_.solve(right); }
  [[nodiscard]] bool converged() const { return solver_.info() == Eigen::Success; }

 private:
  Eigen::ConjugateGradient<RowMatrix, Eigen::Lower | Eigen::Upper> solver_;
};

// The pairs of one mode by Lanczos, in the inner product of C. Steps whose vectors are already spanned end it.
class Relaxations {
 public:
  Relaxations(const RowMatrix& capacity, const RowMatrix& shifted, double shift)
      : capacity_(capacity), mass_(capacity), shifted_(shifted), shift_(shift) {}

  [[nodiscard]] bool converged() const { return mass_.converged() && shifted_.converged(); }

  // `b` is the column of warmth; false when an iteration did not converge.
  bool find(const Eigen::VectorXd& b, double lambda, Eigen::Ref<Eigen::VectorXd> pairs) const {
    constexpr double kSpanned = 1e-10;
    pairs.setZero();
    Eigen::VectorXd x = mass_(b), before = Eigen::VectorXd::Zero(b.size());
    const Eigen::VectorXd ones = capacity_ * Eigen::VectorXd::Ones(b.size());
    x.array() -= ones.dot(x) / ones.sum();  // what warms as a whole loses nothing
    Eigen::VectorXd weighed = capacity_ * x;
    const double strength = x.dot(weighed);
    if (!(strength > 0)) return converged();
    x /= std::sqrt(strength);
    weighed /= std::sqrt(strength);
    Eigen::MatrixXd tridiagonal = Eigen::MatrixXd::Zero(kHeatPairs, kHeatPairs);
    Eigen::Index steps = 0;
    double coupling = 0;
    while (steps < kHeatPairs) {
      Eigen::VectorXd next = shifted_(weighed) - coupling * before;
      const double own = next.dot(weighed);
      tridiagonal(steps, steps) = own;
      if (steps > 0) tridiagonal(steps - 1, steps) = tridiagonal(steps, steps - 1) = coupling;
      ++steps;
      next -= own * x;
      weighed = capacity_ * next;
      coupling = std::sqrt(std::max(next.dot(weighed), 0.0));
      if (coupling <= kSpanned * std::abs(own)) break;
      before = std::exchange(x, next / coupling);
      weighed /= coupling;
    }
    const dense::Spectrum spectrum = dense::spectrum(tridiagonal.topLeftCorner(steps, steps));
    for (Eigen::Index j = 0; j < steps; ++j) {
      const double rate = 1 / spectrum.values[j] - shift_, weight = spectrum.vectors(0, j);
      if (!(rate > 0)) continue;
      pairs[2 * j] = strength * weight * weight / lambda;
      pairs[2 * j + 1] = rate;
    }
    return converged();
  }

 private:
  const RowMatrix& capacity_;
  Solver mass_, shifted_;
  double shift_;
};

}  // namespace

// Both matrices have one entry for each pair of nodes of an element; the pattern is sorted out by Eigen.
HeatProblem::HeatProblem(const HeatSource& source, int threads)
    : source_(source),
      threads_(thread_count(threads)),
      heat_mesh_(source.mesh.order() < 3 ? mesh::to_order(source.mesh, 3) : source.mesh) {
  const BlasThreads one(1);
  const int order = heat_mesh_.order();
  const Rule rule(order, order);
  const Eigen::Index n = heat_mesh_.elements.cols(), points = static_cast<Eigen::Index>(rule.points.size());
  std::vector<Eigen::Triplet<double>> conduction, capacity;
  conduction.reserve(static_cast<std::size_t>(heat_mesh_.elements.size() * n));
  capacity.reserve(conduction.capacity());
  Eigen::MatrixXd weighted(n, points), mass(n, n), stiffness(n, n);
  std::array<Eigen::MatrixXd, 3> gradients{weighted, weighted, weighted};
  for (Eigen::Index e = 0; e < heat_mesh_.elements.rows(); ++e) {
    const mesh::ElementNodes nodes = mesh::nodes_of(heat_mesh_, e);
    const HeatRatios& ratios = source.parts[source.part_of.empty() ? 0 : source.part_of[e]];
    for (Eigen::Index q = 0; q < points; ++q) {
      const mesh::ReferenceGradient& reference = rule.warmed.gradients[q];
      const Eigen::Matrix3d jacobian = mesh::jacobian(nodes, reference);
      const double volume = jacobian.determinant() / 6 * rule.points[q].weight;
      weighted.col(q) = ratios.capacity * volume * rule.warmed.values.col(q);
      const double root = std::sqrt(ratios.conductivity * volume);
      const Eigen::Matrix3d inverse = jacobian.inverse();
      for (int i = 0; i < 3; ++i) gradients[i].col(q) = root * (reference * inverse.row(i).transpose());
    }
    dense::set_product(mass, weighted, rule.warmed.values.transpose());
    stiffness.setZero();
    for (const Eigen::MatrixXd& along : gradients) dense::add_product(stiffness, 1, along, along.transpose());
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b < n; ++b) {
        conduction.emplace_back(heat_mesh_.elements(e, a), heat_mesh_.elements(e, b), stiffness(a, b));
        capacity.emplace_back(heat_mesh_.elements(e, a), heat_mesh_.elements(e, b), mass(a, b));
      }
    }
  }
  for (auto [matrix, entries] : {std::pair{&conduction_, &conduction}, std::pair{&capacity_, &capacity}}) {
    matrix->resize(heat_mesh_.nodes.rows(), heat_mesh_.nodes.rows());
    matrix->setFromTriplets(entries->begin(), entries->end());
  }
}

// Threads share the modes, so that each sum is in the order of the elements.
Eigen::MatrixXd HeatProblem::warmth(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const {
  const BlasThreads one(1);
  const mesh::TetMesh& mesh = source_.mesh;
  const Rule rule(mesh.order(), heat_mesh_.order());
  const Eigen::Index n = mesh.elements.cols(), points = static_cast<Eigen::Index>(rule.points.size());
  std::vector<Eigen::Matrix<double, 6, 1>> stresses;
  for (const Law& law : source_.solid.laws()) stresses.push_back(thermal_stress(law));
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(heat_mesh_.nodes.rows(), shapes.cols());
  in_parallel(threads_, [&](int thread) {
    const Eigen::Index first = shapes.cols() * thread / threads_, last = shapes.cols() * (thread + 1) / threads_;
    if (first == last) return;
    Eigen::MatrixXd pressed(points, 3 * n), moved(3 * n, last - first), pressure(points, last - first),
        added(heat_mesh_.elements.cols(), last - first);
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      const mesh::ElementNodes nodes = mesh::nodes_of(mesh, e);
      const double expansion = source_.parts[source_.part_of.empty() ? 0 : source_.part_of[e]].expansion;
      const auto& law_of = source_.solid.law_of();
      const auto& stress = stresses[law_of.empty() ? 0 : law_of[e]];
      Eigen::Matrix3d beta;
      beta << stress[0], stress[5], stress[4], stress[5], stress[1], stress[3], stress[4], stress[3], stress[2];
      for (Eigen::Index q = 0; q < points; ++q) {
        const mesh::ReferenceGradient& reference = rule.moved.gradients[q];
        const Eigen::Matrix3d jacobian = mesh::jacobian(nodes, reference);
        const double weight = expansion * jacobian.determinant() / 6 * rule.points[q].weight;
        const Eigen::Matrix3d turned = weight * (jacobian.inverse().transpose() * beta);
        for (Eigen::Index a = 0; a < n; ++a) pressed.row(q).segment<3>(3 * a) = reference.row(a) * turned;
      }
      for (Eigen::Index a = 0; a < n; ++a)
        moved.middleRows<3>(3 * a) =
            shapes.middleRows<3>(3 * Eigen::Index{mesh.elements(e, a)}).middleCols(first, last - first);
      dense::set_product(pressure, pressed, moved);
      dense::set_product(added, rule.warmed.values, pressure);
      for (Eigen::Index a = 0; a < added.rows(); ++a)
        sum.row(heat_mesh_.elements(e, a)).segment(first, last - first) += added.row(a);
    }
  });
  return sum;
}

Result<Eigen::MatrixXd> heat_relaxations(const HeatSource& source, const Eigen::Ref<const Eigen::MatrixXd>& shapes,
                                         const Eigen::VectorXd& lambda, const Progress& progress, int threads) {
  if (progress && !progress("heat", 0)) return fail_cancelled();
  const int count = thread_count(threads);
  const HeatProblem problem(source, threads);
  const Eigen::MatrixXd warmth = problem.warmth(shapes);
  const double shift = kShift / (source.wall * source.wall);
  const RowMatrix shifted = problem.conduction() + shift * problem.capacity();
  Eigen::MatrixXd pairs(2 * kHeatPairs, shapes.cols());
  std::atomic<bool> converged = true, cancelled = false;
  std::atomic<Eigen::Index> next = 0;
  in_parallel(count, [&](int thread) {
    const Relaxations relaxations(problem.capacity(), shifted, shift);
    for (Eigen::Index m = next++; m < shapes.cols() && !cancelled; m = next++) {
      if (!relaxations.find(warmth.col(m), lambda[m], pairs.col(m))) converged = false;
      if (thread == 0 && progress && !progress("heat", static_cast<double>(m) / static_cast<double>(shapes.cols())))
        cancelled = true;
    }
  });
  if (cancelled) return fail_cancelled();
  if (!converged)
    return fail(ErrorKind::bad_input,
                "the flow of heat in it could not be computed; its elements are too flat or too distorted: mesh the "
                "object again");
  return pairs;
}

}  // namespace ringdown::fem
