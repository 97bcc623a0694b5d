// Arranges things without a place of their own on shelves: beside each other, in rows. [any]
#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace ringdown::viewer {

// Returns the lowest corner [m] of each thing with these extents in x and y. Things are placed in order from left to
// right, in rows that follow each other in y, with gaps. The arrangement begins at (0, 0) and suits a picture that is
// wider than high.
std::vector<glm::vec2> on_shelves(std::span<const glm::vec2> extents_m);

}  // namespace ringdown::viewer
