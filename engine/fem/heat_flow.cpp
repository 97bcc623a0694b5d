#include "engine/fem/heat_flow.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"

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
constexpr double kShift = 50;        // over wall^2; between the rates of the first and the third way through the wall
constexpr double kTolerance = 1e-6;  // of residuals

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

// Some columns side by side, so that one pass over a matrix serves all of them.
constexpr int kSideBySide = 8;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, kSideBySide, Eigen::RowMajor>;
using PerColumn = Eigen::Array<double, 1, kSideBySide>;

void multiply(const RowMatrix& matrix, const Columns& x, Columns& product) {
  const int* first = matrix.outerIndexPtr();
  const int* column = matrix.innerIndexPtr();
  const double* value = matrix.valuePtr();
  product.resize(x.rows(), kSideBySide);
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    PerColumn sum = PerColumn::Zero();
    for (int k = first[row]; k < first[row + 1]; ++k) sum += value[k] * x.row(column[k]).array();
    product.row(row) = sum;
  }
}

PerColumn dots(const Columns& a, const Columns& b) {
  PerColumn sum = PerColumn::Zero();
  for (Eigen::Index row = 0; row < a.rows(); ++row) sum += a.row(row).array() * b.row(row).array();
  return sum;
}

// a / b, and 0 where b is.
PerColumn ratio(const PerColumn& a, const PerColumn& b) { return (b != 0).select(a / (b != 0).select(b, 1), 0); }

void add(Columns& sum, const PerColumn& factor, const Columns& x) {
  for (Eigen::Index row = 0; row < sum.rows(); ++row) sum.row(row).array() += factor * x.row(row).array();
}

// An approximate inverse of a matrix on the nodes of a mesh: the sum over all elements of the inverse of the matrix's
// block at the element's nodes, which are weighted so that each node counts once (additive Schwarz with overlap:
// Toselli & Widlund, Domain Decomposition Methods, 2005, section 3.2). Where elements are flat, conjugate gradients
// need a small part of the steps that they need with the diagonal alone. An inverse is kept as its root, L^-1 of the
// block L L^T, so that it stays positive definite where single precision rounds it.
class ElementInverses {
 public:
  ElementInverses(const RowMatrix& matrix, const mesh::TetMesh& mesh) : elements_(mesh.elements) {
    const dense::BlasThreads one(1);
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(mesh.nodes.rows());
    for (const auto node : elements_.reshaped()) ++counts[node];
    const Eigen::Index n = elements_.cols();
    roots_.reserve(static_cast<std::size_t>(elements_.rows() * n * (n + 1) / 2));
    Eigen::MatrixXd block(n, n), root;
    for (Eigen::Index e = 0; e < elements_.rows(); ++e) {
      for (Eigen::Index a = 0; a < n; ++a) {
        for (Eigen::Index b = 0; b <= a; ++b) block(a, b) = matrix.coeff(elements_(e, a), elements_(e, b));
      }
      const Eigen::VectorXd diagonal = block.diagonal();
      root.setIdentity(n, n);
      if (dense::cholesky(block)) {
        dense::solve_lower(block, root);
      } else {
        root.diagonal() = diagonal.cwiseSqrt().cwiseInverse();
      }
      for (Eigen::Index a = 0; a < n; ++a) {
        for (Eigen::Index b = 0; b <= a; ++b)
          roots_.push_back(static_cast<float>(root(a, b) / std::sqrt(counts[elements_(e, b)])));
      }
    }
  }

  void apply(const Columns& x, Columns& product) const {
    using Row = Eigen::Array<float, 1, kSideBySide>;
    const Eigen::Index n = elements_.cols();
    Eigen::Array<float, Eigen::Dynamic, kSideBySide, Eigen::RowMajor> from(n, kSideBySide), to(n, kSideBySide);
    product.setZero(x.rows(), kSideBySide);
    const float* root = roots_.data();
    for (Eigen::Index e = 0; e < elements_.rows(); ++e) {
      for (Eigen::Index a = 0; a < n; ++a) from.row(a) = x.row(elements_(e, a)).cast<float>();
      to.setZero();
      for (Eigen::Index a = 0; a < n; ++a) {
        Row sum = Row::Zero();  // row a of the root times `from`
        for (Eigen::Index b = 0; b <= a; ++b) sum += root[b] * from.row(b);
        for (Eigen::Index b = 0; b <= a; ++b) to.row(b) += root[b] * sum;
        root += a + 1;
      }
      for (Eigen::Index a = 0; a < n; ++a) product.row(elements_(e, a)) += to.row(a).cast<double>().matrix();
    }
  }

 private:
  const decltype(mesh::TetMesh::elements)& elements_;
  std::vector<float> roots_;  // the lower triangles, row by row, element by element
};

// Conjugate gradients for each column on its own. Eigen's solver takes one column at a time, and so reads the matrix
// eight times as often.
class Solver {
 public:
  Solver(const RowMatrix& matrix, const ElementInverses& inverses) : matrix_(matrix), inverses_(inverses) {}

  // False when the residual of a column did not fall to kTolerance of its right side.
  [[nodiscard]] bool solve(const Columns& right, Columns& x) {
    constexpr int kMaxSteps = 5000;
    x.setZero(right.rows(), kSideBySide);
    residual_ = right;
    inverses_.apply(residual_, scaled_);
    direction_ = scaled_;
    const PerColumn small = kTolerance * kTolerance * dots(right, right);
    PerColumn power = dots(residual_, scaled_);
    for (int step = 0; step < kMaxSteps; ++step) {
      if ((dots(residual_, residual_) <= small).all()) return true;
      multiply(matrix_, direction_, product_);
      const PerColumn length = ratio(power, dots(direction_, product_));
      add(x, length, direction_);
      add(residual_, -length, product_);
      inverses_.apply(residual_, scaled_);
      const PerColumn before = std::exchange(power, dots(residual_, scaled_));
      const PerColumn share = ratio(power, before);
      for (Eigen::Index row = 0; row < x.rows(); ++row)
        direction_.row(row).array() = scaled_.row(row).array() + share * direction_.row(row).array();
    }
    return false;
  }

 private:
  const RowMatrix& matrix_;
  const ElementInverses& inverses_;
  Columns residual_, scaled_, direction_, product_;
};

// The pairs of some modes by Lanczos, in the inner product of C.
class Relaxations {
 public:
  Relaxations(const RowMatrix& capacity, Solver mass, Solver shifted, double shift)
      : capacity_(capacity), mass_(std::move(mass)), shifted_(std::move(shifted)), shift_(shift) {
    ones_ = capacity * Eigen::VectorXd::Ones(capacity.cols());
  }

  // `warmth` is b of kSideBySide modes at most, `pairs` a column for each; false when an iteration did not converge.
  bool find(const Eigen::Ref<const Eigen::MatrixXd>& warmth, const Eigen::Ref<const Eigen::VectorXd>& lambda,
            Eigen::Ref<Eigen::MatrixXd> pairs) {
    Columns right = Columns::Zero(warmth.rows(), kSideBySide), x, next, weighed;
    right.leftCols(warmth.cols()) = warmth;
    bool good = mass_.solve(right, x);
    x.rowwise() -= (ones_.transpose() * x / ones_.sum()).eval();  // what warms as a whole loses nothing
    multiply(capacity_, x, weighed);
    const PerColumn strength = dots(x, weighed);
    scale(x, weighed, strength);
    std::array<PerColumn, kHeatPairs> own;
    std::array<PerColumn, kHeatPairs + 1> coupling{PerColumn::Zero()};
    Columns before = Columns::Zero(x.rows(), kSideBySide);
    for (int step = 0; step < kHeatPairs; ++step) {
      good = shifted_.solve(weighed, next) && good;
      add(next, -coupling[step], before);
      own[step] = dots(next, weighed);
      add(next, -own[step], x);
      multiply(capacity_, next, weighed);
      const PerColumn left = dots(next, weighed);
      coupling[step + 1] = left.max(0).sqrt();
      before = std::exchange(x, next);
      scale(x, weighed, left);
    }
    for (Eigen::Index m = 0; m < warmth.cols(); ++m) {
      pairs.col(m) = gauss_rule(m, own, coupling, strength[m] / lambda[m]);
    }
    return good;
  }

 private:
  static void scale(Columns& x, Columns& weighed, const PerColumn& square) {
    const PerColumn factor = (square > 0).select(square.max(1e-300).rsqrt(), 0);
    x.array().rowwise() *= factor;
    weighed.array().rowwise() *= factor;
  }

  // The nodes and weights of column `m`, as strengths and rates. A step whose vector was already spanned ends it.
  [[nodiscard]] Eigen::VectorXd gauss_rule(Eigen::Index m, const std::array<PerColumn, kHeatPairs>& own,
                                           const std::array<PerColumn, kHeatPairs + 1>& coupling,
                                           double strength) const {
    constexpr double kSpanned = 1e-7;
    Eigen::VectorXd pairs = Eigen::VectorXd::Zero(2 * kHeatPairs);
    if (!(strength > 0)) return pairs;
    Eigen::MatrixXd tridiagonal = Eigen::MatrixXd::Zero(kHeatPairs, kHeatPairs);
    Eigen::Index steps = 0;
    for (; steps < kHeatPairs && (steps == 0 || coupling[steps][m] > kSpanned * own[0][m]); ++steps) {
      tridiagonal(steps, steps) = own[steps][m];
      if (steps > 0) tridiagonal(steps - 1, steps) = tridiagonal(steps, steps - 1) = coupling[steps][m];
    }
    const dense::Spectrum spectrum = dense::spectrum(tridiagonal.topLeftCorner(steps, steps));
    for (Eigen::Index j = 0; j < steps; ++j) {
      const double rate = 1 / spectrum.values[j] - shift_, weight = spectrum.vectors(0, j);
      if (!(rate > 0)) continue;
      pairs[2 * j] = strength * weight * weight;
      pairs[2 * j + 1] = rate;
    }
    return pairs;
  }

  const RowMatrix& capacity_;
  Solver mass_, shifted_;
  double shift_;
  Eigen::VectorXd ones_;  // C 1
};

}  // namespace

// K and C have one entry for each pair of nodes of an element; Eigen sorts out the pattern.
HeatProblem::HeatProblem(const HeatSource& source, int threads)
    : source_(source),
      threads_(thread_count(threads)),
      heat_mesh_(source.mesh.order() < 3 ? mesh::to_order(source.mesh, 3) : source.mesh) {
  const dense::BlasThreads one(1);
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
  const dense::BlasThreads one(1);
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
  const ElementInverses of_capacity(problem.capacity(), problem.mesh()), of_shifted(shifted, problem.mesh());
  Eigen::MatrixXd pairs(2 * kHeatPairs, shapes.cols());
  std::atomic<bool> converged = true, cancelled = false;
  std::atomic<Eigen::Index> next = 0;
  in_parallel(count, [&](int thread) {
    Relaxations relaxations(problem.capacity(), {problem.capacity(), of_capacity}, {shifted, of_shifted}, shift);
    for (Eigen::Index m = next.fetch_add(kSideBySide); m < shapes.cols() && !cancelled;
         m = next.fetch_add(kSideBySide)) {
      const Eigen::Index some = std::min<Eigen::Index>(kSideBySide, shapes.cols() - m);
      if (!relaxations.find(warmth.middleCols(m, some), lambda.segment(m, some), pairs.middleCols(m, some)))
        converged = false;
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
