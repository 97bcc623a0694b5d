// A bank of the same object in a scaled material and size, as a mixer would play it. [worker]
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

namespace ringdown::modal {

// Frequencies, the stated pitch, decays, shapes, points, mass, the material and its grain, nonlinear terms and what
// modes radiate, each scaled exactly (material_scale.h), but for radiation under another stiffness or density, which
// follows its levels. Modes that become over-damped are left out; the order of the others stays.
Bank scaled(const Bank& bank, const MaterialScale& scale);

}  // namespace ringdown::modal
