// Operations of a team of threads on whole blocks, and a growing set of vectors that is kept in blocks. [worker]
#pragma once

#include "engine/solve/lanes.h"
#include "engine/solve/large_pages.h"
#include "engine/solve/team.h"

#include <vector>

namespace ringdown::solve {

// The operations of lanes.h on all unknowns, shared among the team's threads.
Small inner_products(Team& team, const Block& y, const Block& x);
void combine_in_place(Team& team, const Small& factors, Block& x);
void copy(Team& team, const Block& from, Block& to);

class Basis {
 public:
  explicit Basis(Team& team) : team_(team) {}

  void append(const Block& block);
  [[nodiscard]] int size() const { return kWidth * static_cast<int>(blocks_.size()); }

  // Inner products of every vector of the basis with those of the block: size() x kWidth.
  [[nodiscard]] Eigen::MatrixXd inner_products(const Block& x) const;

  // x -= (V factors)^T, for factors of size() x kWidth.
  void subtract_combination(const Eigen::MatrixXd& factors, Block& x) const;

  // x -= (V_b factors)^T, for the vectors V_b of block number `block`.
  void subtract_combination(int block, const Small& factors, Block& x) const;

  // V factors: 3N x columns, for factors of size() x columns.
  [[nodiscard]] Eigen::MatrixXd combine(const Eigen::MatrixXd& factors) const;

 private:
  [[nodiscard]] std::vector<const double*> block_data() const;

  Team& team_;
  Eigen::Index unknowns_ = 0;
  std::vector<Numbers> blocks_;  // blocks of vectors, each in the layout of Block
};

}  // namespace ringdown::solve
