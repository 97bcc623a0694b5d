#include "engine/fem/surplus.h"

#include "engine/dense/decompositions.h"
#include "engine/dense/products.h"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <vector>

// The element's matrices, from one product
//
// All of the element's matrices are blocks of one matrix over the functions of W and of V together: the integrals of
// products of their gradients, which gradient_products() computes. In a straight element the gradients are those of the
// reference element times one constant matrix, so the integral is the reference element's, summed once, transformed; in
// a curved element it is a sum over quadrature points. stiffness() turns a block of it into elastic energy. relaxed()
// subtracts from the energy of W the part that V can relax within the element, a Schur complement by Cholesky factors.
// V's own energy is singular in the six rigid motions, so these are first given some stiffness; W does not couple with
// them.
namespace ringdown::fem {
namespace {

// A value with its derivatives by the four barycentric coordinates, as if they were independent.
struct Slope {
  double value = 0;
  Eigen::Vector4d slope = Eigen::Vector4d::Zero();
};

Slope operator+(const Slope& a, const Slope& b) { return {a.value + b.value, a.slope + b.slope}; }
Slope operator*(double s, const Slope& a) { return {s * a.value, s * a.slope}; }
Slope operator-(const Slope& a, const Slope& b) { return a + -1 * b; }
Slope operator*(const Slope& a, const Slope& b) { return {a.value * b.value, b.value * a.slope + a.value * b.slope}; }

using Slopes = std::vector<Slope>;

// The Jacobi polynomial of weight (1, 1) and degree p - 1 in b - a, made homogeneous with a + b.
Slope edge_factor(int order, const Slope& a, const Slope& b) {
  const Slope x = b - a, t = a + b;
  switch (order) {
    case 1:
      return Slope{1};
    case 2:
      return x;
    case 3:
      return 5 * x * x - t * t;
    default:
      return (7 * x * x - 3 * t * t) * x;
  }
}

// Degree p - 2 on a triangle, orthogonal to lower degrees with the weight abc, homogeneous with a + b + c.
Slopes face_factors(int order, const Slope& a, const Slope& b, const Slope& c) {
  if (order < 2) return {};
  if (order == 2) return Slopes{Slope{1}};
  const Slope x = b - a, t = a + b, s = a + b + c;
  if (order == 3) return {x, 3 * c - s};
  return {5 * x * x - t * t, x * (4 * c - s), 28 * c * c - 21 * c * s + 3 * s * s};
}

// Degree p - 3 in the tetrahedron, orthogonal to lower degrees with the weight l0 l1 l2 l3.
Slopes inner_factors(int order, const std::array<Slope, 4>& l) {
  if (order < 3) return {};
  if (order == 3) return Slopes{Slope{1}};
  return {l[1] - l[0], 2 * l[2] - l[0] - l[1], 3 * l[3] - l[0] - l[1] - l[2]};
}

Slopes all_functions(int order, const Eigen::Vector4d& barycentric) {
  assert(order >= 1 && order <= mesh::kMaxOrder);
  std::array<Slope, 4> l;
  for (int i = 0; i < 4; ++i) l[i] = {barycentric[i], Eigen::Vector4d::Unit(i)};
  Slopes functions;
  for (const auto& [a, b] : kRisingEdges) functions.push_back(l[a] * l[b] * edge_factor(order, l[a], l[b]));
  for (const auto& [a, b, c] : kRisingFaces) {
    for (const Slope& factor : face_factors(order, l[a], l[b], l[c])) functions.push_back(l[a] * l[b] * l[c] * factor);
  }
  for (const Slope& factor : inner_factors(order, l)) functions.push_back(l[0] * l[1] * l[2] * l[3] * factor);
  return functions;
}

}  // namespace

Eigen::VectorXd surplus_shape(int order, const Eigen::Vector4d& barycentric) {
  const Slopes functions = all_functions(order, barycentric);
  Eigen::VectorXd values(surplus_per_element(order));
  for (Eigen::Index a = 0; a < values.size(); ++a) values[a] = functions[a].value;
  return values;
}

mesh::ReferenceGradient surplus_gradient(int order, const Eigen::Vector4d& barycentric) {
  const Slopes functions = all_functions(order, barycentric);
  mesh::Barycentric d(surplus_per_element(order), 4);
  for (Eigen::Index a = 0; a < d.rows(); ++a) d.row(a) = functions[a].slope.transpose();
  return d.rightCols<3>().colwise() - d.col(0);
}

namespace {

using CornerOrder = std::array<int, 4>;

// Returns, for each place of a node, the node that moves there when the corners are put in the order `corners`.
std::vector<int> nodes_in_order(int order, const CornerOrder& corners) {
  const mesh::Barycentric points = mesh::reference_nodes(order);
  std::vector<int> from;
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    Eigen::RowVector4d place;
    for (int i = 0; i < 4; ++i) place[corners[i]] = points(a, i);
    Eigen::Index nearest = 0;
    (points.rowwise() - place).rowwise().squaredNorm().minCoeff(&nearest);
    from.push_back(static_cast<int>(nearest));
  }
  return from;
}

mesh::Indices with_rising_corners(const mesh::TetMesh& mesh) {
  std::map<CornerOrder, std::vector<int>> known;
  mesh::Indices sorted(mesh.elements.rows(), mesh.elements.cols());
  for (Eigen::Index e = 0; e < sorted.rows(); ++e) {
    CornerOrder corners = {0, 1, 2, 3};
    std::sort(corners.begin(), corners.end(), [&](int a, int b) { return mesh.elements(e, a) < mesh.elements(e, b); });
    const auto [from, is_new] = known.try_emplace(corners);
    if (is_new) from->second = nodes_in_order(mesh.order(), corners);
    for (Eigen::Index a = 0; a < sorted.cols(); ++a) sorted(e, a) = mesh.elements(e, from->second[a]);
  }
  return sorted;
}

struct Parts {
  mesh::Indices numbers;  // E x kinds: numbers of each element's edges, or of its faces
  int count = 0;
};

template <std::size_t kCorners, std::size_t kKinds>
Parts number_parts(const mesh::Indices& elements, const std::array<std::array<int, kCorners>, kKinds>& kinds) {
  using Part = std::array<std::int32_t, kCorners>;
  std::vector<Part> all;
  all.reserve(kKinds * static_cast<std::size_t>(elements.rows()));
  for (Eigen::Index e = 0; e < elements.rows(); ++e) {
    for (const auto& kind : kinds) {
      Part& part = all.emplace_back();
      for (std::size_t i = 0; i < kCorners; ++i) part[i] = elements(e, kind[i]);
    }
  }
  std::vector<Part> unique = all;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  Parts parts{mesh::Indices(elements.rows(), kKinds), static_cast<int>(unique.size())};
  std::transform(all.begin(), all.end(), parts.numbers.data(), [&](const Part& part) {
    return static_cast<std::int32_t>(std::lower_bound(unique.begin(), unique.end(), part) - unique.begin());
  });
  return parts;
}

}  // namespace

SurplusSpace surplus_space(const mesh::TetMesh& mesh) {
  SurplusSpace space;
  space.nodes = with_rising_corners(mesh);
  const auto elements = static_cast<int>(space.nodes.rows());
  const Parts edges = number_parts(space.nodes, kRisingEdges), faces = number_parts(space.nodes, kRisingFaces);
  const int per_face = surplus_per_face(mesh.order()), inside = surplus_inside(mesh.order());
  const int first_of_faces = edges.count, first_inside = first_of_faces + per_face * faces.count;

  space.functions.resize(elements, surplus_per_element(mesh.order()));
  for (int e = 0; e < elements; ++e) {
    std::int32_t* function = space.functions.row(e).data();
    for (const std::int32_t edge : edges.numbers.row(e)) *function++ = edge;
    for (const std::int32_t face : faces.numbers.row(e)) {
      for (int k = 0; k < per_face; ++k) *function++ = first_of_faces + per_face * face + k;
    }
    for (int k = 0; k < inside; ++k) *function++ = first_inside + inside * e + k;
  }

  for (int edge = 0; edge < edges.count; ++edge) space.parts.push_back(edge);
  for (int face = 0; per_face > 0 && face < faces.count; ++face) {
    space.parts.push_back(first_of_faces + per_face * face);
  }
  for (int e = 0; inside > 0 && e < elements; ++e) space.parts.push_back(first_inside + inside * e);
  space.parts.push_back(first_inside + inside * elements);
  return space;
}

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

// error_estimate.cpp explains kRelaxed and softened().
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

// K of an anisotropic solid from the products of gradients.
MatrixXd stiffness(const MatrixXd& products, const Matrix6& law, int row, int rows, int column, int columns) {
  const Eigen::Index all = products.rows() / 3;
  MatrixXd result = MatrixXd::Zero(3 * rows, 3 * columns);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      auto block = result.block(i * rows, j * columns, rows, columns);
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          const double factor = law(voigt(i, k), voigt(j, l));
          if (factor != 0) block += factor * products.block(k * all + row, l * all + column, rows, columns);
        }
      }
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

SurplusElement::SurplusElement(int order) : w_(surplus_per_element(order)), n_(mesh::nodes_per_element(order)) {
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
    surplus_.col(q) = surplus_shape(order, at);
    shapes_.col(q) = mesh::interpolation(order, at);
    gradients_.emplace_back(all, 3);
    gradients_.back() << surplus_gradient(order, at), mesh::interpolation_gradient(order, at);
    const Eigen::MatrixXd column = gradients_.back().reshaped();
    dense::add_product(straight_products_, weights_[q], column, column.transpose());
  }
  straight_mass_ = dense::product_transposed(surplus_ * weights_.asDiagonal(), shapes_);
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
  mass = dense::product_transposed(surplus_ * volumes.asDiagonal(), shapes_);
  return dense::product_transposed(gradients * volumes.asDiagonal(), gradients);
}

Eigen::MatrixXf SurplusElement::relaxed(const MatrixXd& products, const mesh::ElementNodes& nodes,
                                        const Law& law) const {
  const double mu = law.elastic.mu_pa(), lambda = softened(law.elastic.lambda_pa(), mu);
  const auto part = [&](int row, int rows, int column, int columns) {
    return law.stiffness_pa ? stiffness(products, *law.stiffness_pa, row, rows, column, columns)
                            : stiffness(products, lambda, mu, row, rows, column, columns);
  };
  MatrixXd energy = part(0, w_, 0, w_);
  MatrixXd lower = part(w_, n_, w_, n_);
  const MatrixXd rigid = rigid_motions(nodes);
  lower += lower.diagonal().mean() * dense::product_transposed(rigid, rigid);  // these six are singular in K
  if (dense::cholesky(lower)) {
    MatrixXd half = part(w_, n_, 0, w_);
    dense::solve_lower(lower, half);
    energy -= kRelaxed * dense::transposed_product(half, half);
  }
  return energy.cast<float>();
}

SurplusMatrices SurplusElement::operator()(const mesh::ElementNodes& nodes, const Law& law) const {
  SurplusMatrices element;
  const MatrixXd products = gradient_products(nodes, element.mass);
  const Elastic& elastic = law.elastic;
  element.mass *= elastic.density_kg_m3;
  element.coupling = law.stiffness_pa ? stiffness(products, *law.stiffness_pa, 0, w_, w_, n_)
                                      : stiffness(products, elastic.lambda_pa(), elastic.mu_pa(), 0, w_, w_, n_);
  element.energy = relaxed(products, nodes, law);
  return element;
}

}  // namespace ringdown::fem
