// The part of repair that needs half-edges: taking apart, sewing, closing. By CGAL. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

struct Sewn {
  TriangleMesh mesh;
  int parted = 0;      // points doubled because surfaces ran together there
  int sewn = 0;        // pairs of border edges joined
  int closed = 0;      // holes
  int flattened = 0;   // triangles without area, taken out without leaving a hole
  int left_open = 0;   // holes
};

// Closes flat holes, and others of at most `longest_hole` [m] around. No triangle may name a node twice or be a copy.
Sewn sew(const TriangleMesh& mesh, double longest_hole_m);

}  // namespace ringdown::mesh
