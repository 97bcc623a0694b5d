// Parameters that make modes hit their targets: a small nonlinear least-squares problem with bounds. [any thread]
//
//   const auto cents_of = [&](const Eigen::VectorXd& p) -> Result<Eigen::VectorXd> { ...bake and compare... };
//   Result<Tuned> tuned = tune({{"length", 250, 400, 300}, {"arch_depth", 2, 14, 6}}, cents_of, {});
//   if (tuned && !tuned->reached) ...tuned->cents says how far off the best is...
//
// Levenberg-Marquardt in parameters counted from low (0) to high (1). Slopes are forward differences at first and
// Broyden's rank-one updates from then on, so that a step costs one evaluation; they are measured again only where a
// step on updated slopes failed. With fewer targets than parameters the answer is one near the start.
//
// Deterministic. Throws nothing and knows nothing of sound: the numbers may be any residuals, but are called cents.
#pragma once

#include "engine/base/result.h"

#include <Eigen/Core>

#include <functional>
#include <string>
#include <vector>

namespace ringdown::bake {

struct TuneVariable {
  std::string name;
  double low = 0, high = 1;  // low < high
  double start = 0.5;        // brought inside when it is not
};

// Residuals [cents], as many every time, at these parameters (in their own units, inside the bounds). One that cannot
// be evaluated is stepped around, unless it is the first.
using CentsOf = std::function<Result<Eigen::VectorXd>(const Eigen::VectorXd& parameters)>;

struct TuneOptions {
  double tolerance_cents = 0.3;  // every residual, to stop
  int max_evaluations = 80;
  double probe = 0.01;     // a forward difference's step, of high - low
  Eigen::MatrixXd slopes;  // residuals x parameters [cents per (high - low)], from an earlier run; empty: measured
  std::function<bool()> stopped;  // asked before each evaluation
};

struct Tuned {
  Eigen::VectorXd parameters, cents;  // the best found
  Eigen::MatrixXd slopes;
  int evaluations = 0;
  bool reached = false;  // all cents within the tolerance
};

// Fails when the first evaluation does, when none of its neighbours can be evaluated, or with ErrorKind::cancelled.
Result<Tuned> tune(const std::vector<TuneVariable>& variables, const CentsOf& cents_of, const TuneOptions& options);

}  // namespace ringdown::bake
