// The surface of the liquid in an object, for drawing. [any]
#pragma once

#include "clients/viewer/render/drawn_mesh.h"
#include "engine/modal/bank.h"

#include <optional>

namespace ringdown::viewer {

// The level cuts the bank's surface in closed lines. The largest one with the wall around it bounds the liquid, whose
// surface is drawn as a fan about that line's middle. Nothing where no such line is, as in an empty basin.
std::optional<DrawnMesh> liquid_surface(const modal::Bank& bank, double level_m);

}  // namespace ringdown::viewer
