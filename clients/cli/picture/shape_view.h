// Surfaces as pictures, seen from the front right, above; z is up. A mode shape is bent by the mode and coloured by the
// displacement of each place; a pattern of pieces has a colour for each piece. [any]
#pragma once

#include "clients/cli/picture/axis.h"
#include "engine/base/vec3.h"
#include "engine/modal/bank.h"
#include "engine/modal/fracture/fracture.h"

namespace ringdown::cli {

inline constexpr std::size_t kMaxDrawn = 20000;  // triangles or points; a larger surface is not drawn

// Returns a place as all views show it, from the front right, above: x to the right, y up, z towards the eye.
Vec3 seen_from_front(Vec3 place);

// Draws the shape. Marks the place `struck`, if there is one. Without triangles, draws the sample points.
void draw_shape(Canvas& canvas, const Box& box, const modal::Bank& bank, std::size_t mode,
                const std::size_t* struck = nullptr);

// Draws the pieces of a pattern, each moved away from the body's centre by `apart` times its distance from there.
// Pieces without modes are grey. Marks the place of the blow if the pieces are together, `apart` = 0.
void draw_pieces(Canvas& canvas, const Box& box, const modal::BreakPattern& pattern, double apart);

}  // namespace ringdown::cli
