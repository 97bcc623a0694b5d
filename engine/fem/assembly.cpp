#include "engine/fem/assembly.h"

#include "engine/base/in_parallel.h"
#include "engine/dense/blas_threads.h"
#include "engine/fem/element.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <limits>
#include <new>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

// Assembly without a list of entries
//
// 1. The pattern. Two nodes share an entry when they share an element. For each node the elements around it are
//    listed, and from them its neighbours in ascending order (node_graph()). The compressed columns of K and M follow
//    from the graph alone, with zeros for values (lay_out_stiffness(), lay_out_mass()).
// 2. The values, batch by batch, so that the element matrices stay in the cache. First the threads share the
//    elements of a batch and integrate them (element.h). Then they share the columns of the matrices: each thread goes
//    through all elements of the batch and adds those blocks that belong to its own columns (Scatter).
//
// So no two threads write to one entry, and each entry is summed in the order of the elements whatever the number of
// threads: the matrices are the same to the last bit.
namespace ringdown::fem {
namespace {

// Node n shares an element with neighbors[first[n]] ... neighbors[first[n+1] - 1], ascending. The node itself is among
// them, at own[n].
struct NodeGraph {
  std::vector<int> first, own, neighbors;

  [[nodiscard]] int node_count() const { return static_cast<int>(own.size()); }
};

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
struct Neighbours {
  Neighbours(const mesh::TetMesh& mesh, const ElementsOfNodes& around, int begin, int end) {
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
  Neighbours() = default;

  std::vector<int> neighbors, counts, before_own;
};

NodeGraph node_graph(const mesh::TetMesh& mesh, int threads) {
  const auto node_count = static_cast<int>(mesh.nodes.rows());
  const ElementsOfNodes around(mesh);
  std::vector<Neighbours> parts(threads);
  in_parallel(threads, [&](int thread) {
    const auto [begin, end] = share(node_count, thread, threads);
    parts[thread] = Neighbours(mesh, around, begin, end);
  });

  NodeGraph graph;
  graph.first.assign(1, 0);
  for (const Neighbours& part : parts) {
    for (std::size_t n = 0; n < part.counts.size(); ++n) {
      graph.own.push_back(graph.first.back() + part.before_own[n]);
      graph.first.push_back(graph.first.back() + part.counts[n]);
    }
    graph.neighbors.insert(graph.neighbors.end(), part.neighbors.begin(), part.neighbors.end());
  }
  return graph;
}

// Lays out every entry of the stiffness, with the value 0: the lower triangle of a matrix of 3 x 3 blocks. Column 3n+j
// holds rows j..2 of the diagonal block, then three rows of each later neighbour.
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
  if (entries > std::numeric_limits<int>::max()) throw std::bad_alloc();  // this many entries take 26 GB
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

// Lays out every entry of the mass, with the value 0: one number for each pair of neighbours, in both triangles. A
// lumped mass has only the diagonal.
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

constexpr Eigen::Index kBatchBytes = 32 << 20;    // element matrices of a batch
constexpr Eigen::Index kElementsPerThread = 100;  // fewer are finished before a thread has started

// The matrices of a run of elements, one after the other.
class Batch {
 public:
  Batch(int order, Eigen::Index elements)
      : nodes_(mesh::nodes_per_element(order)),
        stiffness_(9 * nodes_ * nodes_ * elements),
        mass_(nodes_ * nodes_ * elements) {}

  [[nodiscard]] Eigen::Map<Eigen::MatrixXd> stiffness(Eigen::Index k) {
    return {stiffness_.data() + 9 * nodes_ * nodes_ * k, 3 * nodes_, 3 * nodes_};
  }
  [[nodiscard]] Eigen::Map<Eigen::MatrixXd> mass(Eigen::Index k) {
    return {mass_.data() + nodes_ * nodes_ * k, nodes_, nodes_};
  }

 private:
  Eigen::Index nodes_;
  std::vector<double> stiffness_, mass_;
};

// Adds element matrices to those columns of a system that belong to the nodes from `begin` to `end`.
class Scatter {
 public:
  Scatter(const NodeGraph& graph, int begin, int end, System& system)
      : graph_(graph), begin_(begin), end_(end), system_(system) {}

  template <class ElementNodes, class Stiffness, class Mass>
  void add(const ElementNodes& nodes, const Stiffness& stiffness, const Mass& mass) {
    const auto count = static_cast<int>(nodes.size());
    std::iota(ascending_.begin(), ascending_.begin() + count, 0);
    std::sort(ascending_.begin(), ascending_.begin() + count, [&](int a, int b) { return nodes[a] < nodes[b]; });
    for (int b = 0; b < count; ++b) {
      const int column = nodes[b];
      if (column < begin_ || column >= end_) continue;
      auto found = graph_.neighbors.begin() + graph_.first[column];
      const auto last = graph_.neighbors.begin() + graph_.first[column + 1];
      for (int k = 0; k < count; ++k) {
        const int a = ascending_[k];
        found = std::lower_bound(found, last, nodes[a]);
        const auto position = static_cast<int>(found - graph_.neighbors.begin());
        add_mass(position, column, mass(a, b), a == b);
        if (nodes[a] >= column) add_stiffness(position, column, stiffness, a, b);
      }
    }
  }

 private:
  void add_mass(int position, int column, double mass, bool diagonal) {
    if (!lumped_) system_.node_mass.valuePtr()[position] += mass;
    if (lumped_ && diagonal) system_.node_mass.valuePtr()[column] += mass;
  }

  template <class Stiffness>
  void add_stiffness(int position, int column, const Stiffness& stiffness, int a, int b) {
    const int block = 3 * (position - graph_.own[column]);
    for (int j = 0; j < 3; ++j) {
      double* entries = system_.stiffness.valuePtr() + system_.stiffness.outerIndexPtr()[3 * column + j] + block - j;
      for (int i = a == b ? j : 0; i < 3; ++i) entries[i] += stiffness(3 * a + i, 3 * b + j);
    }
  }

  const NodeGraph& graph_;
  int begin_, end_;
  System& system_;
  bool lumped_ = system_.node_mass.nonZeros() == system_.node_mass.cols();
  std::array<int, mesh::nodes_per_element(mesh::kMaxOrder)> ascending_{};
};

// One range of columns for each thread, with about the same number of entries.
std::vector<Scatter> share_columns(const NodeGraph& graph, int threads, System& system) {
  const int* outer = system.stiffness.outerIndexPtr();
  const std::int64_t entries = system.stiffness.nonZeros();
  std::vector<Scatter> shares;
  for (int thread = 0, begin = 0; thread < threads; ++thread) {
    int end = begin;
    while (end < graph.node_count() && outer[3 * end] < entries * (thread + 1) / threads) ++end;
    if (thread + 1 == threads) end = graph.node_count();
    shares.emplace_back(graph, begin, end, system);
    begin = end;
  }
  return shares;
}

// Threads first share the elements of a batch, then the columns to which the elements are added.
void add_elements(const mesh::TetMesh& mesh, const Solid& solid, Element element, int threads, const NodeGraph& graph,
                  System& system) {
  const int order = mesh.order();
  const auto element_bytes =
      static_cast<Eigen::Index>(10 * sizeof(double)) * mesh.elements.cols() * mesh.elements.cols();
  const Eigen::Index per_batch = std::min(mesh.elements.rows(), kBatchBytes / element_bytes);
  Batch batch(order, per_batch);
  std::vector<ElementIntegrals> integrals(threads, ElementIntegrals(order));
  std::vector<Scatter> shares = share_columns(graph, threads, system);
  for (Eigen::Index first = 0; first < mesh.elements.rows(); first += per_batch) {
    const Eigen::Index count = std::min(per_batch, mesh.elements.rows() - first);
    in_parallel(threads, [&](int thread) {
      for (Eigen::Index k = count * thread / threads; k < count * (thread + 1) / threads; ++k) {
        integrals[thread](nodes_of(mesh, first + k), solid.at(first + k), batch.stiffness(k), batch.mass(k));
        if (element == Element::kTet4Lumped) {
          batch.mass(k) = lumped_mass(corners_of(mesh, first + k), solid.at(first + k).elastic.density_kg_m3);
        }
      }
    });
    in_parallel(threads, [&](int thread) {
      for (Eigen::Index k = 0; k < count; ++k) {
        shares[thread].add(mesh.elements.row(first + k), batch.stiffness(k), batch.mass(k));
      }
    });
  }
}

// Builds the matrices in place, because Eigen's sparse matrices cannot be moved.
Result<System> assemble_checked(const mesh::TetMesh& mesh, const Solid& solid, Element element, int threads) {
  const NodeGraph graph = node_graph(mesh, threads);
  Result<System> system = System{};
  lay_out_stiffness(graph, threads, system->stiffness);
  lay_out_mass(graph, element == Element::kTet4Lumped, system->node_mass);
  add_elements(mesh, solid, element, threads, graph, *system);
  return system;
}

}  // namespace

Result<System> assemble(const mesh::TetMesh& mesh, const Solid& solid, Element element, int threads) {
  assert(mesh.order() == order_of(element));
  if (auto stable = check_solid(solid); !stable) return fail(stable);
  const auto useful = static_cast<int>(mesh.elements.rows() / kElementsPerThread + 1);
  const dense::BlasThreads one(1);
  try {
    return assemble_checked(mesh, solid, element, std::min(thread_count(threads), useful));
  } catch (const std::exception&) {
    return fail(ErrorKind::no_memory, "not enough memory for the matrices of {} nodes; make the mesh coarser",
                mesh.nodes.rows());
  }
}

void apply_mass(const SparseMatrix& node_mass, const double* x, double* y) {
  const int* outer = node_mass.outerIndexPtr();
  const int* inner = node_mass.innerIndexPtr();
  const double* values = node_mass.valuePtr();
  for (Eigen::Index n = 0; n < node_mass.cols(); ++n) {  // symmetric: column n is row n
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

}  // namespace ringdown::fem
