// The pencil K - sigma M of one system: its order of elimination, and the factorization at the last shift. [worker]
//
//   Pencil pencil(system, threads);
//   Result<Count> top = pencil.factor(highest_lambda, kUp);
//   top->below;           // eigenvalues below top->lambda, by inertia
//   pencil.factors();     // stays until the next factor()
//
// The second opinion and all methods of engine/solve but SLEPc work on this one factorization.
#pragma once

#include "engine/solve/ldlt.h"

#include <functional>

namespace ringdown::solve {

// The number of eigenvalues below a shift, by Sylvester's law of inertia.
struct Count {
  double lambda;
  int below;
};

// Called at intervals with an estimate of the share done, 0..1. When it returns false, Cancelled (methods.h) is thrown.
using KeepGoing = std::function<bool(double)>;

class Pencil {
 public:
  // `system` must live longer.
  Pencil(const fem::System& system, int threads);

  // The direction in which a shift moves when it lies too close to an eigenvalue of a leading part of the system.
  enum Step { kUp, kDown };

  // Factors at lambda, or up to three steps of 0.03 % away if the factors would lose digits there.
  Result<Count> factor(double lambda, Step step, const KeepGoing& keep_going = {});

  // Frees the memory that only factoring needs.
  void release_workspace() { factors_.release_workspace(); }

  [[nodiscard]] const fem::System& system() const { return system_; }
  [[nodiscard]] const Elimination& plan() const { return plan_; }
  [[nodiscard]] const OrderedSystem& ordered() const { return ordered_; }
  [[nodiscard]] const Ldlt& factors() const { return factors_; }
  [[nodiscard]] Team& team() const { return team_; }

  [[nodiscard]] Eigen::Index unknowns() const { return system_.unknowns(); }
  [[nodiscard]] int factorizations() const { return factorizations_; }
  [[nodiscard]] double factor_seconds() const { return factor_seconds_; }  // wall time

  // Vectors (3N x m) converted from one order of unknowns to the other.
  [[nodiscard]] Eigen::MatrixXd in_mesh_order(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const;
  [[nodiscard]] Eigen::MatrixXd in_elimination_order(const Eigen::Ref<const Eigen::MatrixXd>& shapes) const;

 private:
  const fem::System& system_;
  mutable Team team_;
  const Elimination plan_;
  const OrderedSystem ordered_;
  Ldlt factors_;
  int factorizations_ = 0;
  double factor_seconds_ = 0;
};

}  // namespace ringdown::solve
