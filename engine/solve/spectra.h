// Eigenvalues nearest to a shift, by Spectra over the pencil's factorization. [worker]
//
// Spectra's Lanczos iteration works on one vector at a time and restarts. It shares the factors with block_lanczos()
// and nothing else: the order of unknowns, the product with M, the start, the orthogonalization and the test of
// convergence are separate code. Therefore Spectra can give a second opinion.
#pragma once

#include "engine/solve/block_lanczos.h"
#include "engine/solve/eigensolver.h"

namespace ringdown::solve {

// Finds the `count` eigenpairs nearest to the pencil's shift, the nearest first, with shapes in the order of the mesh.
// Eigenpairs in the span of `locked` (3N x l, M-orthonormal, order of the mesh; may have no columns) are left out.
// `tolerance` is relative, on theta. A run may find fewer vectors of a multiple eigenvalue than there are; another run,
// with the found ones locked, finds more. `complete` is false when not all converged. Throws Cancelled.
Pairs nearest_by_spectra(const Pencil& pencil, int count, double tolerance, const Eigen::MatrixXd& locked,
                         const KeepGoing& keep_going);

// Method::kSpectra: finds all modes below `top`, from a shift a little below zero, in as many runs as are needed to
// find the number counted at the top. Fills lambda, shapes, solves and seconds.
Result<Eigenmodes> solve_spectra(Pencil& pencil, const Count& top, const EigenRequest& request,
                                 const Progress& progress);

}  // namespace ringdown::solve
