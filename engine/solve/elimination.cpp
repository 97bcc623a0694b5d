// The search for the order, step by step.
//
// 1. METIS orders the mesh's nodes by nested dissection.
// 2. The elimination tree of that order is numbered in postorder, so that subtrees are runs of columns.
// 3. Neighbouring columns with one pattern below the diagonal form fundamental supernodes.
// 4. Children join their parents where that stores few zeros, because larger dense blocks are worth a few zeros.
// 5. Whole subtrees are dealt to the parts, one part per thread, and the crown above them is numbered last.
#include "engine/solve/elimination.h"

#include "engine/solve/tiles.h"

#include <metis.h>

#include <algorithm>
#include <mutex>
#include <numeric>
#include <utility>

namespace ringdown::solve {
namespace {

// The neighbours of each node, without the node itself.
struct Graph {
  std::vector<idx_t> first{0}, neighbors;
  [[nodiscard]] int size() const { return static_cast<int>(first.size()) - 1; }
};

Graph node_graph(const fem::SparseMatrix& stiffness) {
  const int count = static_cast<int>(stiffness.cols()) / 3;
  const int *outer = stiffness.outerIndexPtr(), *inner = stiffness.innerIndexPtr();
  // Column 3n of the lower triangle names node n's later neighbours, three rows each.
  const auto each_pair = [&](auto&& visit) {
    for (int n = 0; n < count; ++n) {
      for (int k = outer[3 * n] + 3; k < outer[3 * n + 1]; k += 3) visit(n, inner[k] / 3);
    }
  };
  Graph graph;
  graph.first.assign(count + 1, 0);
  each_pair([&](int a, int b) {
    ++graph.first[a + 1];
    ++graph.first[b + 1];
  });
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  graph.neighbors.resize(graph.first.back());
  std::vector<idx_t> fill(graph.first.begin(), graph.first.end() - 1);
  each_pair([&](int a, int b) {
    graph.neighbors[fill[a]++] = b;
    graph.neighbors[fill[b]++] = a;
  });
  return graph;
}

std::vector<int> nested_dissection(Graph& graph) {
  idx_t count = graph.size();
  std::vector<idx_t> old_of(count), new_of(count);
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  // METIS draws from the C library's rand(), which the whole process shares: two orderings at once would take numbers
  // from each other, and their results would change from run to run.
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  METIS_NodeND(&count, graph.first.data(), graph.neighbors.data(), nullptr, options, old_of.data(), new_of.data());
  return {old_of.begin(), old_of.end()};
}

std::vector<int> inverse(const std::vector<int>& order) {
  std::vector<int> inverse(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) inverse[order[i]] = static_cast<int>(i);
  return inverse;
}

// Parent of each column: the first row below the diagonal of its factor (Liu 1990).
std::vector<int> elimination_tree(const Graph& graph, const std::vector<int>& old_of) {
  const std::vector<int> new_of = inverse(old_of);
  std::vector<int> parent(old_of.size(), -1), ancestor(old_of.size(), -1);
  for (int i = 0; i < graph.size(); ++i) {
    for (idx_t k = graph.first[old_of[i]]; k < graph.first[old_of[i] + 1]; ++k) {
      for (int j = new_of[graph.neighbors[k]]; j != -1 && j < i;) {
        const int next = std::exchange(ancestor[j], i);
        if (next == -1) parent[j] = i;
        j = next;
      }
    }
  }
  return parent;
}

std::vector<std::vector<int>> children_of(const std::vector<int>& parent) {
  std::vector<std::vector<int>> children(parent.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (parent[i] >= 0) children[parent[i]].push_back(static_cast<int>(i));
  }
  return children;
}

// Numbers every vertex after its children and keeps subtrees together.
std::vector<int> postorder(const std::vector<int>& parent) {
  const auto children = children_of(parent);
  std::vector<int> order, stack, visited(parent.size(), 0);
  order.reserve(parent.size());
  for (int root = 0; root < static_cast<int>(parent.size()); ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int top = stack.back();
      if (visited[top] < static_cast<int>(children[top].size())) {
        stack.push_back(children[top][visited[top]++]);
      } else {
        order.push_back(top);
        stack.pop_back();
      }
    }
  }
  return order;
}

// Fundamental supernodes of a postordered matrix, each with the rows below it.
std::vector<Supernode> fundamental_supernodes(const Graph& graph, const std::vector<int>& old_of) {
  const std::vector<int> new_of = inverse(old_of), parent = elimination_tree(graph, old_of);
  const auto children = children_of(parent);
  const int count = graph.size();
  std::vector<std::vector<int>> pattern(count);  // pattern of each column; emptied when the parent has taken it over
  std::vector<int> marked_by(count, -1), supernode_of(count, -1);
  std::vector<Supernode> nodes;
  for (int i = 0; i < count; ++i) {
    const auto add = [&](int row) {
      if (row > i && std::exchange(marked_by[row], i) != i) pattern[i].push_back(row);
    };
    for (idx_t k = graph.first[old_of[i]]; k < graph.first[old_of[i] + 1]; ++k) add(new_of[graph.neighbors[k]]);
    const bool joins = children[i].size() == 1 && children[i][0] == i - 1;
    std::size_t child_rows = 0;
    for (const int child : children[i]) {
      child_rows = pattern[child].size();
      for (const int row : pattern[child]) add(row);
    }
    if (joins && child_rows == pattern[i].size() + 1) {
      supernode_of[i] = supernode_of[i - 1];
      ++nodes[supernode_of[i]].columns;
    } else {
      supernode_of[i] = static_cast<int>(nodes.size());
      nodes.push_back({.first = i, .columns = 1});
    }
    for (const int child : children[i]) {
      if (supernode_of[child] != supernode_of[i]) {
        nodes[supernode_of[child]].rows = std::move(pattern[child]);
        nodes[supernode_of[child]].parent = supernode_of[i];
      }
      std::vector<int>().swap(pattern[child]);
    }
    if (parent[i] < 0) nodes[supernode_of[i]].rows = pattern[i];
  }
  return nodes;
}

// Returns whether larger blocks outweigh the stored zeros, for a supernode with this many node columns and this share
// of zeros.
bool worth_joining(double columns, double zero_share) {
  if (columns <= 6) return zero_share < 0.8;
  if (columns <= 16) return zero_share < 0.3;
  return zero_share < 0.08;
}

// Joins children with their parents where that adds few zeros. Returns the members of each remaining supernode;
// children precede parents.
std::vector<std::vector<int>> join_children(const std::vector<Supernode>& nodes) {
  const int count = static_cast<int>(nodes.size());
  std::vector<int> parent(count), columns(count);
  std::vector<double> zeros(count, 0);
  std::vector<std::vector<int>> members(count), children(count);
  for (int s = 0; s < count; ++s) {
    parent[s] = nodes[s].parent;
    columns[s] = nodes[s].columns;
    members[s] = {s};
    if (parent[s] >= 0) children[parent[s]].push_back(s);
  }
  for (int p = 0; p < count; ++p) {  // children are final before their parent is visited
    std::vector<int> family = std::move(children[p]);
    std::stable_sort(family.begin(), family.end(),
                     [&](int a, int b) { return nodes[a].rows.size() > nodes[b].rows.size(); });
    children[p].clear();
    for (const int c : family) {
      const double rows = static_cast<double>(nodes[p].rows.size()), total = columns[c] + columns[p];
      const double added = columns[c] * (columns[p] + rows - static_cast<double>(nodes[c].rows.size()));
      const double all = total * (total + 1) / 2 + total * rows, zero = zeros[c] + zeros[p] + added;
      if (added > 0 && !worth_joining(total, zero / all)) {
        children[p].push_back(c);
        continue;
      }
      columns[p] += columns[c];
      zeros[p] = zero;
      members[p].insert(members[p].end(), members[c].begin(), members[c].end());
      members[c].clear();
      children[p].insert(children[p].end(), children[c].begin(), children[c].end());
    }
  }
  return members;
}

double flops_of(double pivots, double below) {
  return pivots * pivots * pivots / 3 + pivots * pivots * below + pivots * below * below;
}

// Deals whole subtrees to the parts, the largest first, each to the part with the least work so far. A subtree with
// more than 0.4 of a part's work is split. Returns the part of each supernode, `parts` for the crown.
std::vector<int> deal(const std::vector<int>& parent, const std::vector<double>& work, int parts) {
  const auto children = children_of(parent);
  std::vector<double> subtree(work);
  for (std::size_t s = 0; s < work.size(); ++s) {
    if (parent[s] >= 0) subtree[parent[s]] += subtree[s];
  }
  std::vector<int> open, part(work.size(), -1);
  double total = 0;
  for (std::size_t s = 0; s < work.size(); ++s) {
    if (parent[s] < 0) open.push_back(static_cast<int>(s)), total += subtree[s];
  }
  const auto lighter = [&](int a, int b) { return subtree[a] < subtree[b] || (subtree[a] == subtree[b] && a < b); };
  std::make_heap(open.begin(), open.end(), lighter);
  std::vector<int> whole;
  while (!open.empty()) {
    std::pop_heap(open.begin(), open.end(), lighter);
    const int s = open.back();
    open.pop_back();
    if (parts == 1 || subtree[s] < 0.4 * total / parts) {
      whole.push_back(s);
      continue;
    }
    part[s] = parts;
    for (const int child : children[s]) {
      open.push_back(child);
      std::push_heap(open.begin(), open.end(), lighter);
    }
  }
  std::vector<double> load(parts, 0);
  for (const int s : whole) {
    part[s] = static_cast<int>(std::min_element(load.begin(), load.end()) - load.begin());
    load[part[s]] += subtree[s];
  }
  for (int s = static_cast<int>(work.size()) - 1; s >= 0; --s) {
    if (part[s] < 0) part[s] = part[parent[s]];
  }
  return part;
}

}  // namespace

Elimination plan_elimination(const fem::System& system, int parts) {
  Graph graph = node_graph(system.stiffness);
  std::vector<int> old_of = nested_dissection(graph);
  const auto reorder = [&old_of](const std::vector<int>& order) {
    std::vector<int> next(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) next[i] = old_of[order[i]];
    old_of = std::move(next);
  };
  reorder(postorder(elimination_tree(graph, old_of)));
  std::vector<Supernode> nodes = fundamental_supernodes(graph, old_of);
  const std::vector<std::vector<int>> members = join_children(nodes);

  // The tree of the remaining supernodes is numbered in postorder; the crown goes to the end.
  const auto count = static_cast<int>(nodes.size());
  std::vector<int> joined_into(count), parent(count, -1);
  for (int s = 0; s < count; ++s) {
    for (const int member : members[s]) joined_into[member] = s;
  }
  for (int s = 0; s < count; ++s) {
    if (!members[s].empty() && nodes[s].parent >= 0) parent[s] = joined_into[nodes[s].parent];
  }
  std::vector<double> work(count, 0);
  for (int s = 0; s < count; ++s) {
    double columns = 0;
    for (const int member : members[s]) columns += nodes[member].columns;
    work[s] = flops_of(3 * columns, 3.0 * static_cast<double>(nodes[s].rows.size()));
  }
  const std::vector<int> part = deal(parent, work, parts);
  std::vector<int> sequence = postorder(parent);
  std::erase_if(sequence, [&](int s) { return members[s].empty(); });
  std::stable_sort(sequence.begin(), sequence.end(), [&](int a, int b) { return part[a] < part[b]; });

  Elimination plan;
  plan.part_end.assign(parts, 0);
  std::vector<int> number(count, -1), order;
  for (const int s : sequence) {
    number[s] = static_cast<int>(plan.nodes.size());
    for (int p = part[s]; p < parts; ++p) ++plan.part_end[p];
    Supernode node{.first = static_cast<int>(order.size()), .rows = std::move(nodes[s].rows)};
    std::vector<int> joined = members[s];
    std::sort(joined.begin(), joined.end());
    for (const int member : joined) {
      for (int i = 0; i < nodes[member].columns; ++i) order.push_back(nodes[member].first + i);
    }
    node.columns = static_cast<int>(order.size()) - node.first;
    plan.nodes.push_back(std::move(node));
  }
  const std::vector<int> renumbered = inverse(order);
  for (const int s : sequence) {
    Supernode& node = plan.nodes[number[s]];
    if (parent[s] >= 0) {
      node.parent = number[parent[s]];
      plan.nodes[node.parent].children.push_back(number[s]);
    }
    for (int& row : node.rows) row = renumbered[row];
    std::sort(node.rows.begin(), node.rows.end());
    node.offset = plan.factor_entries;
    plan.factor_entries += tiled_size(node.pivots(), node.below());
    plan.flops += flops_of(node.pivots(), node.below());
  }
  reorder(order);
  plan.old_of = old_of;
  plan.new_of = inverse(old_of);
  return plan;
}

}  // namespace ringdown::solve
