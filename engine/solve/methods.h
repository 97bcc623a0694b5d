// Shared parts and entry points of the methods behind solve_modes(). Private to engine/solve. [worker]
#pragma once

#include "engine/solve/eigensolver.h"
#include "engine/solve/pencil.h"

namespace ringdown::solve {

class SecondOpinion;

// Thrown out of an iteration when Progress asks to stop; solve_modes() catches it.
struct Cancelled {};

// Finds all modes below `top`, slice by slice; the pencil is factored at the top. Asks `opinion`, unless it is null, at
// the first slice's shift. Fills all of Eigenmodes but `rigid`, `counted` and the pencil's own figures.
Result<Eigenmodes> solve_block_lanczos(Pencil& pencil, const Count& top, const EigenRequest& request,
                                       SecondOpinion* opinion, const Progress& progress);

// Finds the modes in other processes, which also count them by inertia. Fills all of Eigenmodes but `rigid`.
Result<Eigenmodes> solve_slepc(const fem::System& system, const EigenRequest& request, const Progress& progress);

// The time of the steady clock [s].
double seconds_now();

}  // namespace ringdown::solve
