// What is done to whole blocks by a team, and a growing set of vectors kept in blocks. [worker]
#pragma once

#include "engine/solve/lanes.h"
#include "engine/solve/large_pages.h"
#include "engine/solve/team.h"

#include <vector>

namespace ringdown::solve {

// As in lanes.h, on all unknowns.
Small inner_products(Team& team, const Block& y, const Block& x);
void combine_in_place(Team& team, const Small& factors, Block& x);
void copy(Team& team, const Block& from, Block& to);

class Basis {
 public:
  explicit Basis(Team& team) : team_(team) {}

  void append(const Block& block);
  [[nodiscard]] int size() const { return kWidth * static_cast<int>(blocks_.size()); }

  // size() x kWidth: inner products of every vector with the block's.
  [[nodiscard]] Eigen::MatrixXd inner_products(const Block& x) const;

  // x -= (V factors)^T, factors of size() x kWidth.
  void subtract_combination(const Eigen::MatrixXd& factors, Block& x) const;

  // The same with one of its blocks only.
  void subtract_combination(int block, const Small& factors, Block& x) const;

  // V factors: 3N x columns, for factors of size() x columns.
  [[nodiscard]] Eigen::MatrixXd combine(const Eigen::MatrixXd& factors) const;

 private:
  [[nodiscard]] std::vector<const double*> places() const;

  Team& team_;
  Eigen::Index unknowns_ = 0;
  std::vector<Numbers> blocks_;  // each as in Block
};

}  // namespace ringdown::solve
