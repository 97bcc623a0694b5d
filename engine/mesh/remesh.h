// The same surface in triangles of another size. By CGAL. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

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
