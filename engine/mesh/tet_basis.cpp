#include "engine/mesh/tet_basis.h"

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

Lattice lattice(int order) {
  const std::vector<Numerators>& nodes = numerators(order);
  Lattice points(nodes_per_element(order), 4);
  for (Eigen::Index a = 0; a < points.rows(); ++a) {
    for (int i = 0; i < 4; ++i) points(a, i) = static_cast<double>(nodes[a][i]) / order;
  }
  return points;
}

std::vector<int> nodes_at(int order, const Lattice& points) {
  const Lattice nodes = lattice(order);
  std::vector<int> found(points.rows(), -1);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    for (int a = 0; a < nodes.rows(); ++a) {
      if ((nodes.row(a) - points.row(k)).norm() < 1e-3) found[k] = a;
    }
  }
  return found;
}

Eigen::VectorXd shape(int order, const Eigen::Vector4d& l) {
  const Factors factors(order, l);
  Eigen::VectorXd values = Eigen::VectorXd::Ones(nodes_per_element(order));
  for (Eigen::Index a = 0; a < values.size(); ++a) {
    for (int i = 0; i < 4; ++i) values[a] *= factors.value[numerators(order)[a][i]][i];
  }
  return values;
}

ReferenceGradient reference_gradient(int order, const Eigen::Vector4d& l) {
  const Factors factors(order, l);
  Lattice d(nodes_per_element(order), 4);  // as if the four l were independent
  for (Eigen::Index a = 0; a < d.rows(); ++a) {
    const Numerators& n = numerators(order)[a];
    for (int i = 0; i < 4; ++i) {
      d(a, i) = factors.slope[n[i]][i];
      for (int j = 0; j < 4; ++j) d(a, i) *= j == i ? 1 : factors.value[n[j]][j];
    }
  }
  return d.rightCols<3>().colwise() - d.col(0);
}

}  // namespace ringdown::mesh
