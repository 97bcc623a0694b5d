// Shelves give places to things that have none of their own: beside each other, in rows. [any]
#pragma once

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace ringdown::viewer {

// Returns the lowest corner [m] of each thing with these extents in x and y: in their order from left to right, in rows
// that follow each other in y. Neighbours keep a gap; a picture wider than high shows all of them well. The whole
// begins at (0, 0).
std::vector<glm::vec2> on_shelves(std::span<const glm::vec2> extents_m);

}  // namespace ringdown::viewer
