// Solves the equation of one wavenumber for a few or many right-hand sides. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/radiate/wave_matrix.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace ringdown::radiate {

// A matrix taken apart by elimination with pivots, in single precision and in its own memory: 8/3 V^3 operations.
class Elimination {
 public:
  explicit Elimination(ComplexMatrix matrix);
  [[nodiscard]] Eigen::MatrixXcf solve(Eigen::MatrixXcf right) const;

 private:
  ComplexMatrix factors_;
  std::vector<int> pivots_;
};

inline constexpr double kResidual = 1e-4;  // relative

// The layers (V x M) for given flows, by GMRES to a residual of kResidual. All right-hand sides are advanced in step,
// so that the matrix is read once for all of them. `near` is the elimination of another matrix, of a wavenumber close
// by, that makes the steps few; without it the diagonal does. Empty when `most_steps` do not suffice, or when `go_on`,
// asked between steps, returns false.
Eigen::MatrixXcf iterate(const ComplexMatrix& matrix, const Eigen::MatrixXcf& flow, const Elimination* near,
                         int most_steps, const std::function<bool()>& go_on);

}  // namespace ringdown::radiate
