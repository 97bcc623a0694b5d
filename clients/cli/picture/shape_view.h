// A mode shape as a picture: the surface, bent by the mode and coloured by the displacement of each place. [any]
#pragma once

#include "clients/cli/picture/axis.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"

namespace ringdown::cli {

inline constexpr std::size_t kMaxDrawn = 20000;  // triangles or points; a larger surface is not drawn

// Returns a place as all views show it, from the front right, above: x to the right, y up, z towards the eye.
Vec3 seen_from_front(Vec3 place);

// Draws the shape seen from the front right, above; z is up. Marks the place `struck`, if there is one. Without
// triangles, draws the sample points.
void draw_shape(Canvas& canvas, const Box& box, const modal::Bank& bank, std::size_t mode,
                const std::size_t* struck = nullptr);

}  // namespace ringdown::cli
