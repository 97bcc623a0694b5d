#include "engine/mesh/surplus_basis.h"

#include <cassert>
#include <vector>

namespace ringdown::mesh {
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
  assert(order >= 1 && order <= kMaxOrder);
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

ReferenceGradient surplus_gradient(int order, const Eigen::Vector4d& barycentric) {
  const Slopes functions = all_functions(order, barycentric);
  Lattice d(surplus_per_element(order), 4);
  for (Eigen::Index a = 0; a < d.rows(); ++a) d.row(a) = functions[a].slope.transpose();
  return d.rightCols<3>().colwise() - d.col(0);
}

}  // namespace ringdown::mesh
