// Surfaces taken apart, closed, and in triangles of another size: what CGAL does on half-edges. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// The same triangles where no edge has more than two of them and those around each point hang together: points are
// doubled where surfaces ran together, and borders that lie on each other joined again, two and two. No triangle may
// name a node twice.
TriangleMesh part(const TriangleMesh& mesh);

// Triangles that span a closed way, as positions in it, turned like the way. Empty when CGAL finds none.
Triangles span(const std::vector<Eigen::RowVector3d>& way);

inline constexpr double kSharpAngle_deg = 40;  // between neighbours' normals: edges that remeshing keeps

struct Remeshed {
  TriangleMesh mesh;
  double deviation_m = 0;  // farthest middle of a triangle or side from the old surface
};

// Triangles with edges about `edge_m` long, on the old surface (Botsch & Kobbelt, A remeshing approach to
// multiresolution modeling, 2004; CGAL's isotropic_remeshing). The surface must be closed and consistent. Fails when
// CGAL cannot.
Result<Remeshed> remesh(const TriangleMesh& surface, double edge_m);

}  // namespace ringdown::mesh
