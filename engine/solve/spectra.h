// Eigenvalues nearest to a shift, by Spectra over the pencil's factorization. [worker]
//
// Spectra's Lanczos iteration works on one vector at a time and restarts. It shares the factors with block_lanczos(),
// and nothing else: the order of unknowns, the product with M, the start, the orthogonalisation and the test of
// convergence are other code. That is what makes it a second opinion.
#pragma once

#include "engine/solve/block_lanczos.h"
#include "engine/solve/eigensolver.h"

namespace ringdown::solve {

// The `count` eigenpairs nearest to the pencil's shift, the nearest first, shapes in the order of the mesh; without
// those in the span of `locked` (3N x l, M-orthonormal, order of the mesh; may have no columns). `tolerance` is that on
// theta, relative. Of a multiple eigenvalue a run may find fewer vectors than there are: run again with those found
// locked. `complete` is false when not all converged. Throws Cancelled.
Pairs nearest_by_spectra(const Pencil& pencil, int count, double tolerance, const Eigen::MatrixXd& locked,
                         const KeepGoing& keep_going);

// Method::kSpectra: all modes below `top`, from a shift a little below zero, as many runs as it takes to find the
// number counted at the top. lambda, shapes, solves and seconds are filled.
Result<Eigenmodes> solve_spectra(Pencil& pencil, const Count& top, const EigenRequest& request,
                                 const Progress& progress);

}  // namespace ringdown::solve
