// Whether the triangles of a bank are a surface that can be struck, shown and collided with.
#pragma once

#include "engine/modal/bank.h"

#include <cstddef>

namespace ringdown::test {

struct BankSurface {
  std::size_t open_edges = 0;  // edges that are not of exactly two triangles with opposite senses
  std::size_t flat = 0;        // triangles without area: of an angle below a hundredth of a degree
  std::size_t needles = 0;     // triangles with an angle below 20 degrees that meet each neighbour at less than 15
  double min_angle_deg = 180;  // of the triangles that meet each neighbour at less than 15 degrees
  double volume_error = 0;     // enclosed volume over that of the body (mass over density) - 1
};

// The bank must have triangles, a mass and a material.
BankSurface look_at_surface(const modal::Bank& bank);

}  // namespace ringdown::test
