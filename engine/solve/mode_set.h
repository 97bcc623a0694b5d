// The modes found so far, in ascending order, whatever iteration found them. [one thread at a time]
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

  // shapes: 3N x count, M-normalised, in the order of elimination.
  void add(const std::vector<double>& lambda, Eigen::MatrixXd shapes);

  // Makes one orthonormal set of the modes about `lambda`, where two iterations met: what both found stays once, and
  // what is close together becomes orthogonal (Rayleigh & Ritz, in the span of what is there).
  void join_at(double lambda);

  // Forgets those at or above `lambda`.
  void drop_from(double lambda) { modes_.erase(at_least(lambda), modes_.end()); }

  [[nodiscard]] int size() const { return static_cast<int>(modes_.size()); }
  [[nodiscard]] double lambda(int i) const { return modes_[i].lambda; }
  [[nodiscard]] auto shape(int i) const { return modes_[i].shape(); }

  // How many have low <= lambda < high; their shapes side by side.
  [[nodiscard]] int count(double low, double high) const;
  [[nodiscard]] Eigen::MatrixXd shapes(double low, double high) const;

 private:
  [[nodiscard]] std::vector<Mode>::iterator at_least(double lambda);
  [[nodiscard]] std::vector<Mode>::const_iterator at_least(double lambda) const;

  const OrderedSystem& system_;
  std::vector<Mode> modes_;
};

}  // namespace ringdown::solve
