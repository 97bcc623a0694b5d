#include "engine/fem/assembly.h"

#include "engine/base/in_parallel.h"
#include "engine/fem/element.h"
#include "engine/fem/node_graph.h"
#include "engine/fem/blas_threads.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace ringdown::fem {
namespace {

struct Kind {
  Element element;
  std::string_view name;
  int order;
};

constexpr std::array kKinds = {Kind{Element::kTet4, "tet4", 1}, Kind{Element::kTet4Lumped, "tet4-lumped", 1},
                               Kind{Element::kTet10, "tet10", 2}, Kind{Element::kTet20, "tet20", 3},
                               Kind{Element::kTet35, "tet35", 4}};

const Kind& kind_of(Element element) {
  return *std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& kind) { return kind.element == element; });
}

constexpr Eigen::Index kBatchBytes = 32 << 20;    // of element matrices
constexpr Eigen::Index kElementsPerThread = 100;  // fewer are done before a thread has started

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

// Threads first share the elements of a batch, then the columns that those are added to.
void add_elements(const mesh::TetMesh& mesh, const Elastic& elastic, Element element, int threads,
                  const NodeGraph& graph, System& system) {
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
        integrals[thread](nodes_of(mesh, first + k), elastic, batch.stiffness(k), batch.mass(k));
        if (element == Element::kTet4Lumped) {
          batch.mass(k) = lumped_mass(corners_of(mesh, first + k), elastic.density_kg_m3);
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

// Eigen's sparse matrices cannot be moved: made where they stay.
Result<System> assemble_checked(const mesh::TetMesh& mesh, const Elastic& elastic, Element element, int threads) {
  const NodeGraph graph = node_graph(mesh, threads);
  Result<System> system = System{};
  lay_out_stiffness(graph, threads, system->stiffness);
  lay_out_mass(graph, element == Element::kTet4Lumped, system->node_mass);
  add_elements(mesh, elastic, element, threads, graph, *system);
  return system;
}

}  // namespace

std::string_view element_name(Element element) { return kind_of(element).name; }
int order_of(Element element) { return kind_of(element).order; }

Result<Element> parse_element(std::string_view name) {
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind.element;
  }
  return fail(ErrorKind::bad_input,
              "unknown element '" + std::string(name) + "'; choose tet10, tet20, tet35, tet4 or tet4-lumped");
}

Result<System> assemble(const mesh::TetMesh& mesh, const Elastic& elastic, Element element, int threads) {
  assert(mesh.order() == order_of(element));
  if (auto stable = check_elastic(elastic); !stable) return fail(stable.error());
  const auto useful = static_cast<int>(mesh.elements.rows() / kElementsPerThread + 1);
  const BlasThreads one(1);
  try {
    return assemble_checked(mesh, elastic, element, std::min(thread_count(threads), useful));
  } catch (const std::exception&) {
    return fail(ErrorKind::no_memory, "not enough memory for the matrices of " + std::to_string(mesh.nodes.rows()) +
                                          " nodes; make the mesh coarser");
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
