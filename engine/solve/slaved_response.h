// The static displacement of a body under a force while some of its modes are held: the answer of all others. [worker]
//
//   SlavedResponse response(system, kept, shift);
//   response.factor();
//   u = response(f);        // K u = f - M kept (kept^T f),  kept^T M u = 0
//
// K is singular, so K - shift M is factored instead, at a shift just below zero. With rigid motions and low modes among
// those held, the relative error is that of the shift over the lowest eigenvalue that is not held.
#pragma once

#include "engine/solve/pencil.h"

namespace ringdown::solve {

class SlavedResponse {
 public:
  // `kept` is 3N x k, M-orthonormal, in the order of the mesh. `system` must live longer. threads = 0: as many as there
  // are processors.
  SlavedResponse(const fem::System& system, const Eigen::MatrixXd& kept, double shift, int threads = 0);

  // Fails when the system cannot be factored, or when `keep_going` says no.
  Result<void> factor(const std::function<bool()>& keep_going = {});

  // 3N x m, a column for each force. Eight at a time.
  [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& forces) const;

 private:
  const Eigen::MatrixXd& kept_;
  const Eigen::MatrixXd heavy_;  // M kept
  const double shift_;
  Pencil pencil_;
};

}  // namespace ringdown::solve
