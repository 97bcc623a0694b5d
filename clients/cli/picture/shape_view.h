// A mode shape as a picture: the surface, bent by the mode and coloured by the displacement of each place. [any]
#pragma once

#include "clients/cli/picture/axis.h"
#include "engine/modal/bank.h"

namespace ringdown::cli {

inline constexpr std::size_t kMaxDrawn = 20000;  // triangles or points; a larger surface is not drawn

// Draws the shape seen from the front right, above; z is up. Marks the place `struck`, if there is one. Without
// triangles, draws the sample points.
void draw_shape(Canvas& canvas, const Box& box, const modal::Bank& bank, std::size_t mode,
                const std::size_t* struck = nullptr);

}  // namespace ringdown::cli
