// The static displacement of a body under a force while some of its modes are held: the response of all other modes.
// [worker]
//
//   SlavedResponse response(system, kept, shift);
//   response.factor();
//   u = response(f);        // K u = f - M kept (kept^T f),  kept^T M u = 0
//
// K is singular, so K - shift M is factored instead, at a shift just below zero. If the held modes include the rigid
// motions and the low modes, the relative error is the ratio of the shift to the lowest eigenvalue that is not held.
#pragma once

#include "engine/solve/pencil.h"

namespace ringdown::solve {

class SlavedResponse {
 public:
  // `kept` is 3N x k, M-orthonormal, in the order of the mesh. `system` must live longer. threads = 0 uses one thread
  // per processor.
  SlavedResponse(const fem::System& system, const Eigen::MatrixXd& kept, double shift, int threads = 0);

  // Fails when the system cannot be factored, or when `keep_going` returns false.
  Result<void> factor(const std::function<bool()>& keep_going = {});

  // Displacements, 3N x m, one column per force. Solves for eight forces at a time.
  [[nodiscard]] Eigen::MatrixXd operator()(const Eigen::MatrixXd& forces) const;

 private:
  const Eigen::MatrixXd& kept_;
  const Eigen::MatrixXd heavy_;  // M kept
  const double shift_;
  Pencil pencil_;
};

}  // namespace ringdown::solve
