// The modes found so far by all iterations, in ascending order. [one thread at a time]
#pragma once

#include "engine/solve/ordered_system.h"

#include <memory>
#include <vector>

namespace ringdown::solve {

class ModeSet {
  struct Mode {
    double lambda;
    std::shared_ptr<const Eigen::MatrixXd> shapes;
    Eigen::Index column;  // of `shapes`

    [[nodiscard]] Eigen::MatrixXd::ConstColXpr shape() const { return shapes->col(column); }
  };

 public:
  explicit ModeSet(const OrderedSystem& system) : system_(system) {}

  // Adds modes. `shapes` is 3N x count, M-normalised, in the order of elimination.
  void add(const std::vector<double>& lambda, Eigen::MatrixXd shapes);

  // Makes one M-orthonormal set of the modes about `lambda`, where the ranges of two iterations meet. A mode that both
  // iterations found is kept once, and modes close together become orthogonal, by the Rayleigh-Ritz method in the span
  // of all found shapes.
  void join_at(double lambda);

  // Removes the modes at or above `lambda`.
  void drop_from(double lambda) { modes_.erase(at_least(lambda), modes_.end()); }

  [[nodiscard]] int size() const { return static_cast<int>(modes_.size()); }
  [[nodiscard]] double lambda(int i) const { return modes_[i].lambda; }
  [[nodiscard]] auto shape(int i) const { return modes_[i].shape(); }

  // The number of modes with low <= lambda < high, and their shapes side by side.
  [[nodiscard]] int count(double low, double high) const;
  [[nodiscard]] Eigen::MatrixXd shapes(double low, double high) const;

 private:
  [[nodiscard]] std::vector<Mode>::iterator at_least(double lambda);
  [[nodiscard]] std::vector<Mode>::const_iterator at_least(double lambda) const;

  const OrderedSystem& system_;
  std::vector<Mode> modes_;
};

}  // namespace ringdown::solve
