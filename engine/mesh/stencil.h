// What isosurface stuffing puts into one tetrahedron of the lattice. [any thread]
//
// Corners are inside, outside or on the surface; an edge from inside to outside has a cut point. The part inside is a
// tetrahedron, a pyramid or a prism with corners at lattice and cut points. Where a face of the lattice holds two
// corners inside and one outside, a quadrilateral is left of it, and both neighbours must choose the same diagonal
// (Labelle & Shewchuk 2007, section 3): one that ends at the cut point of the long edge; where both cut edges are
// short, the one whose lattice point has an even number of coordinates greater than its cut point's.
#pragma once

#include "engine/mesh/bcc_lattice.h"

#include <array>
#include <cstdint>

namespace ringdown::mesh {

enum class Side : std::int8_t { outside = -1, surface = 0, inside = 1 };

// A corner of the lattice's tetrahedron (a == b), or the cut point between a, inside, and b, outside.
struct StencilPoint {
  std::int8_t a = 0, b = 0;
};

struct Stencil {
  int count = 0;
  std::array<std::array<StencilPoint, 4>, 3> elements;  // in no certain orientation
};

// `places` as BccLattice::tetrahedron() has them.
Stencil stencil(const std::array<BccLattice::Place, 4>& places, const std::array<Side, 4>& sides);

}  // namespace ringdown::mesh
