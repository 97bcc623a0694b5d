#include "engine/mesh/tet_element.h"

#include "engine/dense/decompositions.h"

#include <Eigen/LU>

#include <algorithm>
#include <cassert>

namespace ringdown::mesh {
namespace {

using Numerators = std::array<int, 4>;  // n_i = p l_i of a node

std::vector<Numerators> find_numerators(int order) {
  std::vector<Numerators> nodes;
  for (int i = 0; i < 4; ++i) {
    nodes.push_back({});
    nodes.back()[i] = order;
  }
  for (const auto& [first, second] : kTetEdges) {
    for (int k = 1; k < order; ++k) {
      nodes.push_back({});
      nodes.back()[first] = order - k;
      nodes.back()[second] = k;
    }
  }
  for (const auto& [first, second, third] : kTetFaces) {
    for (int a = order - 2; a >= 1; --a) {
      for (int b = order - a - 1; b >= 1; --b) {
        nodes.push_back({});
        nodes.back()[first] = a;
        nodes.back()[second] = b;
        nodes.back()[third] = order - a - b;
      }
    }
  }
  for (int c = 1; c <= order - 3; ++c) {
    for (int b = 1; b <= order - 2 - c; ++b) {
      for (int a = 1; a <= order - 1 - b - c; ++a) nodes.push_back({order - a - b - c, a, b, c});
    }
  }
  return nodes;
}

const std::vector<Numerators>& numerators(int order) {
  assert(order >= 1 && order <= kMaxOrder);
  static const std::array<std::vector<Numerators>, kMaxOrder> all = {find_numerators(1), find_numerators(2),
                                                                     find_numerators(3), find_numerators(4)};
  return all[order - 1];
}

// P_n(l_i) and its derivative, for n = 0 ... order and the four coordinates.
struct Factors {
  double value[kMaxOrder + 1][4], slope[kMaxOrder + 1][4];

  Factors(int order, const Eigen::Vector4d& l) {
    for (int i = 0; i < 4; ++i) {
      value[0][i] = 1;
      slope[0][i] = 0;
      for (int n = 0; n < order; ++n) {
        const double step = (order * l[i] - n) / (n + 1);
        value[n + 1][i] = value[n][i] * step;
        slope[n + 1][i] = slope[n][i] * step + value[n][i] * order / (n + 1);
      }
    }
  }
};

}  // namespace

int order_of_nodes(Eigen::Index nodes) {
  for (int order = 1; order <= kMaxOrder; ++order) {
    if (nodes_per_element(order) == nodes) return order;
  }
  return 0;
}

Barycentric reference_nodes(int order) {
  const std::vector<Numerators>& nodes = numerators(order);
  Barycentric points(nodes_per_element(order), 4);
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    for (int i = 0; i < 4; ++i) points(a, i) = static_cast<double>(nodes[a][i]) / order;
  }
  return points;
}

std::vector<int> nodes_at(int order, const Barycentric& points) {
  const Barycentric nodes = reference_nodes(order);
  std::vector<int> found(points.rows(), -1);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    for (int a = 0; a < nodes.rows(); ++a) {
      if ((nodes.row(a) - points.row(k)).norm() < 1e-3) found[k] = a;
    }
  }
  return found;
}

Eigen::VectorXd interpolation(int order, const Eigen::Vector4d& l) {
  const Factors factors(order, l);
  Eigen::VectorXd values = Eigen::VectorXd::Ones(nodes_per_element(order));
  for (Eigen::Index a = 0; a < values.size(); ++a) {
    for (int i = 0; i < 4; ++i) values[a] *= factors.value[numerators(order)[a][i]][i];
  }
  return values;
}

ReferenceGradient interpolation_gradient(int order, const Eigen::Vector4d& l) {
  const Factors factors(order, l);
  Barycentric d(nodes_per_element(order), 4);  // as if the four l were independent
  for (Eigen::Index a = 0; a < d.rows(); ++a) {
    const Numerators& n = numerators(order)[a];
    for (int i = 0; i < 4; ++i) {
      d(a, i) = factors.slope[n[i]][i];
      for (int j = 0; j < 4; ++j) d(a, i) *= j == i ? 1 : factors.value[n[j]][j];
    }
  }
  return d.rightCols<3>().colwise() - d.col(0);
}

namespace {

struct LineRule {
  Eigen::VectorXd points;   // in (0, 1)
  Eigen::VectorXd weights;  // sum to 1
};

// Gauss rule for the weight (1-t)^power on (0, 1), by the eigenvalues of the Jacobi matrix (Golub & Welsch 1969). The
// recurrence is that of the Jacobi polynomials with exponents (power, 0) on (-1, 1), mapped to (0, 1).
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
  const dense::Spectrum solved = dense::spectrum(jacobi);
  return {(0.5 * (1 + solved.values.array())).matrix(), solved.vectors.row(0).array().square().matrix()};
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
  static const std::array<Barycentric, kMaxOrder> lattices = {reference_nodes(1), reference_nodes(2),
                                                              reference_nodes(3), reference_nodes(4)};
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
