// The choice of another material for an object, from the catalogue (`ringdown materials`): computes the factors that
// give its bank this material, and how far the bank allows it. [UI]
//
// Young's modulus and density of a bank can be scaled, exactly (modal/material_scale.h), and so can its losses where
// both materials have one loss factor at all frequencies; a list that is not constant is matched at 1 kHz. Heat flows
// as strongly as in the wanted material, at the pitch at which it flows in the bank's. Poisson's ratio cannot: the
// bank's value remains until the object is baked again. The effect on the pitch depends on the deformation in a mode:
// none for a thin bar in bending, sqrt((1 - bank^2) / (1 - wanted^2)) for a plate, sqrt((1 + bank) / (1 + wanted)) for
// twisting.
#pragma once

#include "engine/modal/bank.h"
#include "engine/modal/material_scale.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown::viewer {

struct MaterialChoice {
  modal::MaterialScale scale;  // relative to the bank's own material; size 1
  // Relative change of pitch that the material's own Poisson's ratio would add.
  double plate_error = 0, twist_error = 0;
  std::string obstacle;     // one sentence on why the material cannot be chosen; empty: it can
  std::string reservation;  // one sentence on other properties that a bank cannot follow; empty: none
};

// Returns the factors that turn an object of material `bank` into one of material `wanted`.
MaterialChoice choice_of(const modal::Material& bank, const modal::Material& wanted);

// Returns the materials of the catalogue in a folder, or in that of the presets if `given` is empty, sorted by name;
// empty if there is no catalogue. Files that cannot be read are left out.
std::vector<modal::Material> known_materials(const std::filesystem::path& given = {});

// Returns the name of the material that the factors make of material `bank`, at any size: its own name at factors of 1,
// else one of `known`; empty if no material fits.
std::string material_name(const modal::Material& bank, const modal::MaterialScale& scale,
                          const std::vector<modal::Material>& known);

// Returns sentences for a tooltip: the material's figures, the properties that remain the bank's, and the resulting
// errors.
std::string describe(const modal::Material& bank, const modal::Material& wanted);

}  // namespace ringdown::viewer
