// The order in which a sparse symmetric matrix is eliminated, and the entries that fill in. Both are found once for a
// mesh and used for every shift. [worker]
//
// The plan works on nodes, not unknowns, because the three unknowns of a node have the same neighbours. METIS orders
// the nodes by nested dissection. Columns with (nearly) the same pattern below the diagonal are gathered in supernodes,
// so that the factorization works on dense blocks. Source: Davis, Direct Methods for Sparse Linear Systems, SIAM 2006,
// chapter 4; the gathering of children into parents after Ashcraft & Grimes, ACM Trans. Math. Softw. 15, 1989.
#pragma once

#include "engine/fem/assembly.h"

#include <cstddef>
#include <vector>

namespace ringdown::solve {

// A run of columns first..first+columns-1 (node numbers in the order of elimination) that share the rows below them.
struct Supernode {
  int first = 0, columns = 0;
  int parent = -1;  // a later supernode; -1 for a root
  std::vector<int> children;
  std::vector<int> rows;   // nodes below the last column, ascending
  std::size_t offset = 0;  // position of the panel in the array of all factors [doubles]

  [[nodiscard]] int pivots() const { return 3 * columns; }
  [[nodiscard]] int below() const { return 3 * static_cast<int>(rows.size()); }
  [[nodiscard]] int height() const { return pivots() + below(); }
};

// The order of elimination. Supernodes are dealt to parts of about equal work. A part consists of whole subtrees, and
// no entry of the factor connects two parts. The supernodes above all parts, the crown, come last.
struct Elimination {
  std::vector<int> old_of;         // node number in the mesh of each node in the order of elimination
  std::vector<int> new_of;         // the inverse of old_of
  std::vector<Supernode> nodes;    // children before parents
  std::vector<int> part_end;       // part i has supernodes part_end[i - 1] .. part_end[i] - 1
  std::size_t factor_entries = 0;  // doubles of all factors
  double flops = 0;                // operations of one factorization

  [[nodiscard]] int node_count() const { return static_cast<int>(old_of.size()); }
  [[nodiscard]] int parts() const { return static_cast<int>(part_end.size()); }
  [[nodiscard]] int part_begin(int part) const { return part == 0 ? 0 : part_end[part - 1]; }
  [[nodiscard]] int crown_begin() const { return part_end.back(); }
  // The node number at which the columns of a supernode begin.
  [[nodiscard]] int first_column(int supernode) const {
    return supernode < static_cast<int>(nodes.size()) ? nodes[supernode].first : node_count();
  }
  [[nodiscard]] int crown_columns() const { return node_count() - first_column(crown_begin()); }
};

// The result is the same in every run, because METIS gets a fixed seed.
Elimination plan_elimination(const fem::System& system, int parts);

}  // namespace ringdown::solve
