// A mode shape as a picture: the surface, bent by the mode and coloured by how far each place moves. [any]
#pragma once

#include "clients/cli/picture/axis.h"
#include "engine/modal/bank.h"

namespace ringdown::cli {

inline constexpr std::size_t kMaxDrawn = 20000;  // triangles or points; a surface of more is not drawn

// Seen from the front right, above; z is up. The place `struck`, if there is one, gets a mark. Sample points stand for
// the surface of a bank without triangles.
void draw_shape(Canvas& canvas, const Box& box, const modal::Bank& bank, std::size_t mode,
                const std::size_t* struck = nullptr);

}  // namespace ringdown::cli
