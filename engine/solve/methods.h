// What the methods behind solve_modes() share, and their entry points. Private to engine/solve. [worker]
#pragma once

#include "engine/solve/eigensolver.h"
#include "engine/solve/pencil.h"

namespace ringdown::solve {

class SecondOpinion;

// Thrown out of an iteration when Progress says stop; solve_modes() catches it.
struct Cancelled {};

// All modes below `top`, slice by slice; the pencil is factored at the top. Asks `opinion`, unless it is null, about
// the first slice's shift. Fills all of Eigenmodes but `rigid`, `counted` and what the pencil knows.
Result<Eigenmodes> solve_block_lanczos(Pencil& pencil, const Count& top, const EigenRequest& request,
                                       SecondOpinion* opinion, const Progress& progress);

// In other processes, with its own proof; fills all of Eigenmodes but `rigid`.
Result<Eigenmodes> solve_slepc(const fem::System& system, const EigenRequest& request, const Progress& progress);

// Steady clock [s].
double seconds_now();

}  // namespace ringdown::solve
