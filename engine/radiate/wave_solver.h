// Solves the equation of one wavenumber for a few or many right-hand sides. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/radiate/wave_matrix.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace ringdown::radiate {

// A matrix taken apart by elimination with pivots, in its own memory and in single precision: 8/3 V^3 operations.
// Keeps a reference to the matrix, which then holds the factors.
class LuFactors {
 public:
  explicit LuFactors(ComplexMatrix& matrix);
  [[nodiscard]] Eigen::MatrixXcf solve(Eigen::MatrixXcf right) const;

 private:
  ComplexMatrix& factors_;
  std::vector<int> pivots_;
};

// The square matrix times a few columns.
Eigen::MatrixXcf multiply(const ComplexMatrix& matrix, const Eigen::MatrixXcf& columns);

inline constexpr double kResidual = 3e-5;  // relative, of the preconditioned equation

// The layers (V x M) for given flows, by GMRES to a residual for each. All right-hand sides are advanced in step,
// so that the matrix is read once for all of them. `precondition` returns nearly the solutions for right-hand sides, by
// a linear map. Empty when `max_steps` do not suffice, or when `go_on`, asked between steps, returns false.
using Preconditioner = std::function<Eigen::MatrixXcf(const Eigen::MatrixXcf&)>;
Eigen::MatrixXcf iterate(const ComplexMatrix& matrix, const Eigen::MatrixXcf& flow,
                         const std::vector<double>& residuals, const Preconditioner& precondition, int max_steps,
                         const std::function<bool()>& go_on);

}  // namespace ringdown::radiate
