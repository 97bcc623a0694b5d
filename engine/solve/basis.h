// A growing set of vectors, kept in blocks, and its products with one block. [worker]
#pragma once

#include "engine/solve/lanes.h"
#include "engine/solve/team.h"

#include <vector>

namespace ringdown::solve {

class Basis {
 public:
  explicit Basis(Team& team) : team_(team) {}

  void append(const Block& block) { blocks_.push_back(block); }
  [[nodiscard]] int size() const { return kWidth * static_cast<int>(blocks_.size()); }
  [[nodiscard]] const Block& block(int number) const { return blocks_[number]; }

  // size() x kWidth: inner products of every vector with the block's.
  [[nodiscard]] Eigen::MatrixXd inner_products(const Block& x) const;

  // x -= (V factors)^T, factors of size() x kWidth.
  void subtract_combination(const Eigen::MatrixXd& factors, Block& x) const;

  // V factors: 3N x columns, for factors of size() x columns.
  [[nodiscard]] Eigen::MatrixXd combine(const Eigen::MatrixXd& factors) const;

 private:
  Team& team_;
  std::vector<Block> blocks_;
};

}  // namespace ringdown::solve
