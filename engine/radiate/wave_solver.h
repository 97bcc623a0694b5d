// Solves the equation of one wavenumber for any number of right-hand sides. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/radiate/wave_matrix.h"

#include <Eigen/Core>

#include <functional>
#include <vector>

namespace ringdown::radiate {

// Factors a matrix by elimination with pivots, in place and in single precision: 8/3 V^3 operations. Keeps a reference
// to the matrix, which then holds the factors.
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

// Finds the layers (V x M) for given flows by GMRES, each to its own residual. All right-hand sides advance in step, so
// the matrix is read once for all of them. `precondition` is a linear map that returns approximate solutions for
// right-hand sides. Returns an empty matrix when `max_steps` do not suffice, or when `go_on`, called between steps,
// returns false.
using Preconditioner = std::function<Eigen::MatrixXcf(const Eigen::MatrixXcf&)>;
Eigen::MatrixXcf iterate(const ComplexMatrix& matrix, const Eigen::MatrixXcf& flow,
                         const std::vector<double>& residuals, const Preconditioner& precondition, int max_steps,
                         const std::function<bool()>& go_on);

}  // namespace ringdown::radiate
