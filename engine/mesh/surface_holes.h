// Taking apart and closing of surfaces. By CGAL. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// The same triangles where no edge has more than two of them and those around each point hang together: points are
// doubled where surfaces ran together, and borders that lie on each other joined again, two and two. No triangle may
// name a node twice.
TriangleMesh part(const TriangleMesh& mesh);

// Triangles that span a closed way, as positions in it, turned like the way. Empty when CGAL finds none.
Triangles span(const std::vector<Eigen::RowVector3d>& way);

}  // namespace ringdown::mesh
