// Spectra over CHOLMOD: a solver that shares neither iteration nor factors nor order of unknowns with ours.
#pragma once

#include "engine/solve/eigensolver.h"

namespace ringdown::bench {

// The `count` lowest modes, rigid motions too; lambda, shapes, solves and seconds are filled. Nothing is counted or
// proved. The shift is a small negative one, scaled to request.highest_lambda, because K is singular.
Result<solve::Eigenmodes> solve_by_spectra_over_cholmod(const fem::System& system, const solve::EigenRequest& request,
                                                        int count);

}  // namespace ringdown::bench
