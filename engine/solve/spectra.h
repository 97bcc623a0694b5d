// Eigenvalues nearest to a shift, by Spectra over the pencil's factorization. [worker]
//
// Spectra's Lanczos iteration works on one vector at a time and restarts. It shares the factors with block_lanczos()
// and nothing else: the order of unknowns, the product with M, the start, the orthogonalization and the test of
// convergence are other code. Therefore it can give a second opinion.
#pragma once

#include "engine/solve/block_lanczos.h"
#include "engine/solve/eigensolver.h"

namespace ringdown::solve {

// The `count` eigenpairs nearest to the pencil's shift, the nearest first, with shapes in the order of the mesh. Those
// in the span of `locked` (3N x l, M-orthonormal, order of the mesh; may have no columns) are left out. `tolerance` is
// relative, on theta. A run may find fewer vectors of a multiple eigenvalue than there are; another run, with the found
// ones locked, finds more. `complete` is false when not all converged. Throws Cancelled.
Pairs nearest_by_spectra(const Pencil& pencil, int count, double tolerance, const Eigen::MatrixXd& locked,
                         const KeepGoing& keep_going);

// Method::kSpectra: all modes below `top`, from a shift a little below zero, as many runs as it takes to find the
// number counted at the top. lambda, shapes, solves and seconds are filled.
Result<Eigenmodes> solve_spectra(Pencil& pencil, const Count& top, const EigenRequest& request,
                                 const Progress& progress);

}  // namespace ringdown::solve
