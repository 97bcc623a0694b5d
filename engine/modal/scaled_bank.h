// Computes the bank of an object in a scaled material and size, as a mixer would play it. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/modal/bank.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/modal/material_scale.h"

#include <string>

namespace ringdown::modal {

// The levels of a liquid are left out, because its density stays. Scales frequencies, the stated pitch, decays, shapes,
// points, mass, the material and its grain, nonlinear terms and radiation and pieces, each exactly (material_scale.h),
// except that radiation under another stiffness or density follows its levels. Modes that become over-damped are left
// out; the order of the remaining modes stays.
Bank scaled(const Bank& bank, const MaterialScale& scale);

// Returns the patterns of a body of another size, stiffness or density. Modes of pieces that would no longer ring are
// left out. Strength and toughness are the material's own and stay, so the energy of a crack, K_Ic^2 (1 - nu^2) / E,
// falls as the stiffness rises. The skin grows with the size, so a larger body is weaker by Weibull's law.
Fracture scaled(const Fracture& fracture, const MaterialScale& scale);

// Scales all of a body's patterns but the banks of the pieces and what depends on which of their modes ring.
Fracture resized(const Fracture& fracture, const MaterialScale& scale);

// Makes the object `size` times as large. Fails if a mode would no longer ring or a number would overflow; errors begin
// with `name`.
Result<void> scale_size(Bank& bank, double size, const std::string& name);

// Multiplies the points of a bank by `factor`. The bank's other values already belong to the resulting size.
void spread_points(Bank& bank, double factor);

}  // namespace ringdown::modal
