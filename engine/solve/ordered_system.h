// K and M in the order of elimination, as 3 x 3 blocks, and their products with several vectors at once. [worker]
#pragma once

#include "engine/solve/elimination.h"
#include "engine/solve/lanes.h"
#include "engine/solve/team.h"

#include <array>

namespace ringdown::solve {

class OrderedSystem {
 public:
  // `system` is copied; `plan` and `team` must live longer.
  OrderedSystem(const fem::System& system, const Elimination& plan, Team& team);

  [[nodiscard]] int node_count() const { return static_cast<int>(first_.size()) - 1; }
  [[nodiscard]] Eigen::Index unknowns() const { return 3 * static_cast<Eigen::Index>(node_count()); }

  // The entries of a node's column are numbered from begin() to end(); the diagonal entry is the first.
  [[nodiscard]] std::size_t begin(int column) const { return first_[column]; }
  [[nodiscard]] std::size_t end(int column) const { return first_[column + 1]; }
  [[nodiscard]] int row(std::size_t entry) const { return rows_[entry]; }
  [[nodiscard]] double mass(std::size_t entry) const { return masses_[entry]; }  // M's block is mass * I
  // K's block; [3 * i + j] couples component i of the row's node with component j of the column's node.
  [[nodiscard]] const std::array<double, 9>& stiffness(std::size_t entry) const { return stiffnesses_[entry]; }

  // y = M x and y = K x. The team's threads share the parts of the plan. y must not be x.
  void times_mass(const Block& x, Block& y) const;
  void times_stiffness(const Block& x, Block& y) const;

  // |K phi - lambda M phi| / |lambda M phi| of each pair, for shapes (3N x m) in the order of the mesh.
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::VectorXd& lambda, const Eigen::MatrixXd& shapes) const;

 private:
  struct Target;
  using Columns = void (OrderedSystem::*)(int, int, const double*, const Target&) const;
  void mass_columns(int begin, int end, const double* x, const Target& y) const;
  void stiffness_columns(int begin, int end, const double* x, const Target& y) const;
  void multiply(Columns columns, const Block& x, Block& y) const;

  const Elimination& plan_;
  Team& team_;
  std::vector<std::size_t> first_;
  std::vector<int> rows_;
  std::vector<double> masses_;
  std::vector<std::array<double, 9>> stiffnesses_;
};

}  // namespace ringdown::solve
