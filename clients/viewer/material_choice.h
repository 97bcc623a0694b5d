// The choice of another material for an object, from the catalogue (`ringdown materials`): which factors make its bank
// sound so, and how far the bank allows it. [UI]
//
// Young's modulus, density and Rayleigh's two constants of a bank can be scaled, exactly (modal/material_scale.h).
// Poisson's ratio cannot: it stays that of the bank until the object is baked anew. What this does to the pitch depends
// on how a mode bends the body: not at all for a thin bar that bends, sqrt((1 - bank^2) / (1 - wanted^2)) for a plate,
// sqrt((1 + bank) / (1 + wanted)) for what twists.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <string>
#include <vector>

namespace ringdown::viewer {

struct MaterialChoice {
  modal::MaterialScale scale;  // on the bank's own material; size 1
  // By how much, relative, the pitch would be other than the choice makes it, if Poisson's ratio were the material's.
  double plate_error = 0, twist_error = 0;
  std::string obstacle;     // one sentence on why it cannot be chosen; empty: it can
  std::string reservation;  // one sentence on what a bank cannot follow beside Poisson's ratio; empty: nothing
};

// Returns the factors that make an object of material `bank` one of material `wanted`.
MaterialChoice choice_of(const modal::Material& bank, const modal::Material& wanted);

// The materials of the catalogue in the order of their names; empty where there is no catalogue. Files that cannot be
// read are left out.
std::vector<modal::Material> known_materials();

// The name of the material that the factors make of material `bank`, whatever the size: its own name at factors of 1,
// else one of `known`; empty when no material fits.
std::string material_name(const modal::Material& bank, const modal::MaterialScale& scale,
                          const std::vector<modal::Material>& known);

// Sentences for a tooltip: the material's figures, what stays the bank's own, and how far off that is.
std::string describe(const modal::Material& bank, const modal::Material& wanted);

}  // namespace ringdown::viewer
