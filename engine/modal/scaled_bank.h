// Computes the bank of an object in a scaled material and size, as a mixer would play it. [worker]
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

namespace ringdown::modal {

// Scales frequencies, the stated pitch, decays, shapes, points, mass, the material and its grain, nonlinear terms and
// radiation, each exactly (material_scale.h), except that radiation under another stiffness or density follows its
// levels. Modes that become over-damped are left out; the order of the remaining modes stays.
Bank scaled(const Bank& bank, const MaterialScale& scale);

}  // namespace ringdown::modal
