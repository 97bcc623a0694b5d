#include "engine/fem/node_graph.h"

#include "engine/base/in_parallel.h"

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

namespace ringdown::fem {
namespace {

std::pair<int, int> share(std::int64_t count, int thread, int threads) {
  return {static_cast<int>(count * thread / threads), static_cast<int>(count * (thread + 1) / threads)};
}

// Node n belongs to elements[first[n]] ... elements[first[n+1] - 1].
struct ElementsOfNodes {
  explicit ElementsOfNodes(const mesh::TetMesh& mesh)
      : first(mesh.nodes.rows() + 1, 0), elements(mesh.elements.size()) {
    const std::int32_t* nodes = mesh.elements.data();
    for (Eigen::Index k = 0; k < mesh.elements.size(); ++k) ++first[nodes[k] + 1];
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    std::vector<int> next(first.begin(), first.end() - 1);
    for (Eigen::Index k = 0; k < mesh.elements.size(); ++k) {
      elements[next[nodes[k]]++] = static_cast<int>(k / mesh.elements.cols());
    }
  }

  std::vector<int> first, elements;
};

// The neighbours of the nodes from `begin` to `end`, one after the other, and how many each has.
struct Part {
  Part(const mesh::TetMesh& mesh, const ElementsOfNodes& around, int begin, int end) {
    std::vector<int> seen_from(mesh.nodes.rows(), -1), found;
    for (int n = begin; n < end; ++n) {
      found.clear();
      for (int k = around.first[n]; k < around.first[n + 1]; ++k) {
        for (const int neighbor : mesh.elements.row(around.elements[k])) {
          if (std::exchange(seen_from[neighbor], n) != n) found.push_back(neighbor);
        }
      }
      std::sort(found.begin(), found.end());
      neighbors.insert(neighbors.end(), found.begin(), found.end());
      counts.push_back(static_cast<int>(found.size()));
      before_own.push_back(static_cast<int>(std::lower_bound(found.begin(), found.end(), n) - found.begin()));
    }
  }
  Part() = default;

  std::vector<int> neighbors, counts, before_own;
};

}  // namespace

NodeGraph node_graph(const mesh::TetMesh& mesh, int threads) {
  const auto node_count = static_cast<int>(mesh.nodes.rows());
  const ElementsOfNodes around(mesh);
  std::vector<Part> parts(threads);
  in_parallel(threads, [&](int thread) {
    const auto [begin, end] = share(node_count, thread, threads);
    parts[thread] = Part(mesh, around, begin, end);
  });

  NodeGraph graph;
  graph.first.assign(1, 0);
  for (const Part& part : parts) {
    for (std::size_t n = 0; n < part.counts.size(); ++n) {
      graph.own.push_back(graph.first.back() + part.before_own[n]);
      graph.first.push_back(graph.first.back() + part.counts[n]);
    }
    graph.neighbors.insert(graph.neighbors.end(), part.neighbors.begin(), part.neighbors.end());
  }
  return graph;
}

void lay_out_stiffness(const NodeGraph& graph, int threads, Eigen::SparseMatrix<double>& stiffness) {
  const int node_count = graph.node_count();
  stiffness.resize(3 * node_count, 3 * node_count);
  int* outer = stiffness.outerIndexPtr();
  std::int64_t entries = 0;
  for (int n = 0; n < node_count; ++n) {
    for (int j = 0; j < 3; ++j) {
      outer[3 * n + j] = static_cast<int>(entries);
      entries += 3 * (graph.first[n + 1] - graph.own[n]) - j;
    }
  }
  if (entries > std::numeric_limits<int>::max()) throw std::bad_alloc();  // 26 GB of them
  outer[3 * node_count] = static_cast<int>(entries);
  stiffness.resizeNonZeros(entries);
  in_parallel(threads, [&](int thread) {
    const auto [begin, end] = share(node_count, thread, threads);
    int* inner = stiffness.innerIndexPtr() + outer[3 * begin];
    for (int n = begin; n < end; ++n) {
      for (int j = 0; j < 3; ++j) {
        for (int k = graph.own[n]; k < graph.first[n + 1]; ++k) {
          for (int i = k == graph.own[n] ? j : 0; i < 3; ++i) *inner++ = 3 * graph.neighbors[k] + i;
        }
      }
    }
    std::fill(stiffness.valuePtr() + outer[3 * begin], stiffness.valuePtr() + outer[3 * end], 0.0);
  });
}

void lay_out_mass(const NodeGraph& graph, bool lumped, Eigen::SparseMatrix<double>& mass) {
  mass.resize(graph.node_count(), graph.node_count());
  if (lumped) {
    mass.setIdentity();
    mass.coeffs().setZero();
    return;
  }
  mass.resizeNonZeros(static_cast<Eigen::Index>(graph.neighbors.size()));
  std::copy(graph.first.begin(), graph.first.end(), mass.outerIndexPtr());
  std::copy(graph.neighbors.begin(), graph.neighbors.end(), mass.innerIndexPtr());
  std::fill_n(mass.valuePtr(), graph.neighbors.size(), 0.0);
}

}  // namespace ringdown::fem
