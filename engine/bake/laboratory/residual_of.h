// Computes the residual of a bank (modal/response/residual.h): what the modes that it leaves out add to slow motions.
// [worker]
#pragma once

#include "engine/bake/bake.h"
#include "engine/base/progress.h"
#include "engine/modal/response/residual.h"

namespace ringdown::bake {

// Solves the static equations for a force along each axis at each sample point of the bank, with rigid motions and the
// bank's own modes held: twice 3P solutions. A force acts at the point of the body's surface that is nearest to the
// sample point. `baked` has a body with options.equations. Progress stage: "residual". Fails for more than
// kMaxResidualPoints, for a body with liquids, whose matrices are not those of its modes, and when cancelled.
Result<modal::Residual> residual_of(const Baked& baked, const Progress& progress = {});

}  // namespace ringdown::bake
