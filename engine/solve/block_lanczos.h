// Eigenvalues near a shift, by Lanczos iteration with blocks of kWidth vectors. [worker]
//
// The operator is (K - sigma M)^-1 M, whose eigenvalues theta = 1 / (lambda - sigma) are largest near the shift. Each
// step solves for a block at once and makes the result M-orthogonal to all earlier blocks. Therefore no spurious copies
// appear, and all vectors of an eigenvalue of multiplicity up to kWidth are found together. There is no restart: when a
// window holds more eigenvalues than the basis can, the iteration returns a part of them, and the caller sets another
// shift. Sources: Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl. 15, 1994; Ericsson & Ruhe, Math. Comp. 35, 1980
// (the last, free step that purifies a vector).
#pragma once

#include "engine/solve/pencil.h"

#include <vector>

namespace ringdown::solve {

// A Window says which eigenvalues one iteration should find: those from `low` on. The number below the shift is known
// by inertia.
struct Window {
  double low = 0;
  int left = 0;             // eigenvalues in [low, sigma)
  int right = 0;            // eigenvalues wanted from sigma on
  double high = 0;          // finite: [sigma, high) has exactly `right`; infinity: at least the nearest `right`
  int max_vectors = 0;      // size limit of the basis
  double tolerance = 1e-9;  // on the residual of theta, relative
};

struct Pairs {
  std::vector<double> lambda;  // ascending, from window.low to below window.high
  Eigen::MatrixXd shapes;      // 3N x count, M-orthonormal, in the order of elimination
  int solves = 0;              // right-hand sides solved for
  bool complete = false;       // true: all that were asked for; false: only those nearest to the shift that converged
};

// Runs one iteration. `locked` (3N x l, M-orthonormal, order of elimination) are eigenvectors that are known already;
// the result is M-orthogonal to them. `seed` starts the random block. Throws Cancelled.
Pairs block_lanczos(const Pencil& pencil, const Window& window, const Eigen::MatrixXd& locked, unsigned seed,
                    const KeepGoing& keep_going);

}  // namespace ringdown::solve
