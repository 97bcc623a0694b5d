// Eigenvalues near a shift, by Lanczos iteration with blocks of kWidth vectors. [worker]
//
// The operator is (K - sigma M)^-1 M, whose eigenvalues theta = 1 / (lambda - sigma) are largest near the shift. Each
// step solves for a block at once and makes the result M-orthogonal to all earlier blocks. Therefore no spurious copies
// appear, and all vectors of an eigenvalue of multiplicity up to kWidth are found together. There is no restart: when a
// window holds more eigenvalues than the basis can, a part of them is returned, and the caller sets another shift.
// Sources: Grimes, Lewis & Simon, SIAM J. Matrix Anal. Appl. 15, 1994; Ericsson & Ruhe, Math. Comp. 35, 1980 (the last,
// free step that purifies a vector).
#pragma once

#include "engine/solve/pencil.h"

#include <vector>

namespace ringdown::solve {

// A Window says which eigenvalues one iteration is to find: those from `low` on. Inertia tells how many lie below the
// shift.
struct Window {
  double low = 0;
  int left = 0;         // eigenvalues in [low, sigma)
  int right = 0;        // how many more from sigma on ...
  double high = 0;      // ... where `right` are all in [sigma, high), or infinity: then the `right` nearest, or more
  int max_vectors = 0;  // of the basis
  double tolerance = 1e-9;  // on the residual of theta, relative
};

struct Pairs {
  std::vector<double> lambda;  // ascending, from window.low to below window.high
  Eigen::MatrixXd shapes;      // 3N x count, M-orthonormal, in the order of elimination
  int solves = 0;              // right-hand sides
  bool complete = false;       // as many as were asked for; otherwise those nearest to the shift that converged
};

// The result is M-orthogonal to `locked` (3N x l, M-orthonormal, order of elimination): eigenvectors known already.
// `seed` starts the random block. Throws Cancelled.
Pairs block_lanczos(const Pencil& pencil, const Window& window, const Eigen::MatrixXd& locked, unsigned seed,
                    const KeepGoing& keep_going);

}  // namespace ringdown::solve
