#include "engine/fem/assembly.h"

#include "engine/fem/element.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::fem {
namespace {

constexpr std::pair<Element, std::string_view> kElementNames[] = {
    {Element::kTet10, "tet10"}, {Element::kTet4, "tet4"}, {Element::kTet4Lumped, "tet4-lumped"}};

// Which nodes share an element with node n: neighbors[first[n]] .. neighbors[first[n+1]), ascending, n itself
// among them at own[n].
struct NodeGraph {
  std::vector<int> first, own, neighbors;

  [[nodiscard]] int find(int node, int neighbor) const {
    const auto begin = neighbors.begin() + first[node], end = neighbors.begin() + first[node + 1];
    return static_cast<int>(std::lower_bound(begin, end, neighbor) - neighbors.begin());
  }
};

NodeGraph node_graph(const mesh::TetMesh& mesh) {
  const auto node_count = static_cast<int>(mesh.nodes.rows());
  std::vector<int> start(node_count + 1, 0), elements(mesh.elements.size());
  for (const int node : mesh.elements.reshaped()) ++start[node + 1];
  for (int n = 0; n < node_count; ++n) start[n + 1] += start[n];
  std::vector<int> fill(start.begin(), start.end() - 1);
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    for (const int node : mesh.elements.row(e)) elements[fill[node]++] = e;
  }

  NodeGraph graph;
  graph.first.assign(1, 0);
  std::vector<int> seen_from(node_count, -1), found;
  for (int n = 0; n < node_count; ++n) {
    found.clear();
    for (int k = start[n]; k < start[n + 1]; ++k) {
      for (const int neighbor : mesh.elements.row(elements[k])) {
        if (std::exchange(seen_from[neighbor], n) != n) found.push_back(neighbor);
      }
    }
    std::sort(found.begin(), found.end());
    graph.own.push_back(graph.first.back() +
                        static_cast<int>(std::lower_bound(found.begin(), found.end(), n) - found.begin()));
    graph.neighbors.insert(graph.neighbors.end(), found.begin(), found.end());
    graph.first.push_back(static_cast<int>(graph.neighbors.size()));
  }
  return graph;
}

// The lower triangle of a matrix of 3 x 3 blocks: column 3n+j holds rows j..2 of the diagonal block, then
// three rows of each later neighbour.
SparseMatrix empty_stiffness(const NodeGraph& graph) {
  const auto node_count = static_cast<int>(graph.own.size());
  SparseMatrix stiffness(3 * node_count, 3 * node_count);
  int* outer = stiffness.outerIndexPtr();
  int entries = 0;
  for (int n = 0; n < node_count; ++n) {
    for (int j = 0; j < 3; ++j) {
      outer[3 * n + j] = entries;
      entries += 3 * (graph.first[n + 1] - graph.own[n]) - j;
    }
  }
  outer[3 * node_count] = entries;
  stiffness.resizeNonZeros(entries);
  int* inner = stiffness.innerIndexPtr();
  for (int n = 0; n < node_count; ++n) {
    for (int j = 0; j < 3; ++j) {
      for (int k = graph.own[n]; k < graph.first[n + 1]; ++k) {
        for (int i = k == graph.own[n] ? j : 0; i < 3; ++i) *inner++ = 3 * graph.neighbors[k] + i;
      }
    }
  }
  std::fill_n(stiffness.valuePtr(), entries, 0.0);
  return stiffness;
}

SparseMatrix empty_mass(const NodeGraph& graph, bool lumped) {
  const auto node_count = static_cast<int>(graph.own.size());
  SparseMatrix mass(node_count, node_count);
  if (lumped) {
    mass.setIdentity();
    mass.coeffs().setZero();
    return mass;
  }
  mass.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbors.size()));
  std::copy(graph.first.begin(), graph.first.end(), mass.outerIndexPtr());
  std::copy(graph.neighbors.begin(), graph.neighbors.end(), mass.innerIndexPtr());
  std::fill_n(mass.valuePtr(), graph.neighbors.size(), 0.0);
  return mass;
}

template <class StiffnessBlock, class MassBlock, class ElementNodes>
void scatter(const StiffnessBlock& stiffness, const MassBlock& mass, const ElementNodes& nodes, bool lumped,
             const NodeGraph& graph, System& system) {
  const int* outer = system.stiffness.outerIndexPtr();
  double* values = system.stiffness.valuePtr();
  for (int b = 0; b < nodes.size(); ++b) {
    for (int a = 0; a < nodes.size(); ++a) {
      const int row = nodes[a], column = nodes[b];
      if (lumped) {
        if (a == b) system.node_mass.valuePtr()[row] += mass(a, a);
        if (row < column) continue;
      }
      const int position = graph.find(column, row);
      if (!lumped) system.node_mass.valuePtr()[position] += mass(a, b);
      if (row < column) continue;
      const int block = 3 * (position - graph.own[column]);
      for (int j = 0; j < 3; ++j) {
        double* entries = values + outer[3 * column + j] + block - j;
        for (int i = row == column ? j : 0; i < 3; ++i) entries[i] += stiffness(3 * a + i, 3 * b + j);
      }
    }
  }
}

template <class Nodes>
Nodes element_nodes(const mesh::TetMesh& mesh, Eigen::Index element) {
  Nodes nodes;
  for (int a = 0; a < nodes.rows(); ++a) nodes.row(a) = mesh.nodes.row(mesh.elements(element, a));
  return nodes;
}

} // namespace

std::string_view element_name(Element element) {
  for (const auto& [kind, name] : kElementNames) {
    if (kind == element) return name;
  }
  return "";
}

Result<Element> parse_element(std::string_view name) {
  for (const auto& [kind, known] : kElementNames) {
    if (known == name) return kind;
  }
  return fail("unknown element '" + std::string(name) + "'; choose tet10, tet4 or tet4-lumped");
}

Result<System> assemble(const mesh::TetMesh& mesh, const Elastic& elastic, Element element) {
  assert(mesh.quadratic() == (element == Element::kTet10));
  if (auto stable = check_elastic(elastic); !stable) return fail(stable.error());
  const NodeGraph graph = node_graph(mesh);
  const bool lumped = element == Element::kTet4Lumped;
  const double density = elastic.density_kg_m3;
  System system{empty_stiffness(graph), empty_mass(graph, lumped)};
  for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
    if (element == Element::kTet10) {
      const auto nodes = element_nodes<mesh::Nodes10>(mesh, e);
      scatter(stiffness10(nodes, elastic), consistent_mass10(nodes, density), mesh.elements.row(e), lumped,
              graph, system);
    } else {
      const auto corners = element_nodes<mesh::Corners>(mesh, e);
      const Mass4 mass = lumped ? lumped_mass4(corners, density) : consistent_mass4(corners, density);
      scatter(stiffness4(corners, elastic), mass, mesh.elements.row(e), lumped, graph, system);
    }
  }
  return system;
}

void apply_mass(const SparseMatrix& node_mass, const double* x, double* y) {
  const int* outer = node_mass.outerIndexPtr();
  const int* inner = node_mass.innerIndexPtr();
  const double* values = node_mass.valuePtr();
  for (Eigen::Index n = 0; n < node_mass.cols(); ++n) { // symmetric: column n is row n
    double sum[3] = {0, 0, 0};
    for (int k = outer[n]; k < outer[n + 1]; ++k) {
      const double* from = x + 3 * static_cast<std::ptrdiff_t>(inner[k]);
      for (int i = 0; i < 3; ++i) sum[i] += values[k] * from[i];
    }
    for (int i = 0; i < 3; ++i) y[3 * n + i] = sum[i];
  }
}

Eigen::MatrixXd mass_times(const SparseMatrix& node_mass, const Eigen::MatrixXd& x) {
  Eigen::MatrixXd y(x.rows(), x.cols());
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    apply_mass(node_mass, x.col(column).data(), y.col(column).data());
  }
  return y;
}

} // namespace ringdown::fem
