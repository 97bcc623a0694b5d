// Takes surfaces apart, closes holes, and remeshes to another triangle size, with CGAL's half-edge meshes. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// Doubles points where surfaces run together, until no edge has more than two triangles and the triangles around each
// point are connected. Borders that lie on each other are then joined in pairs. No triangle may name a node twice.
TriangleMesh separate(const TriangleMesh& mesh);

// Returns triangles that close a loop of points, as positions in the loop, turned like the loop; none if CGAL finds
// none. Triangles are searched among those of the points' Delaunay tetrahedra, in about O(n log n) for n points; if
// that fails, loops of up to kMaxExactHole points are searched among all triangles, O(n^3).
inline constexpr std::size_t kMaxExactHole = 500;
Triangles triangulate(const std::vector<Eigen::RowVector3d>& loop);

inline constexpr double kSharpAngle_deg = 40;  // angle between neighbours' normals from which remeshing keeps an edge

struct Remeshed {
  TriangleMesh mesh;
  std::vector<double> deviations_m;  // per triangle, largest distance of its middle and its sides' from the old surface
};

struct EdgeLengths {
  double longest_m = 0;    // edge length where the surface is flat
  double shortest_m = 0;   // minimum edge length where the surface bends
  double turn_deg = 45;    // largest turn of the surface between the ends of an edge
  double leave_m = 0;      // largest distance from a curved surface where the body is thin; 0: no limit
  double leave_share = 0;  // the limit where the body is thicker, as a share of its thickness there
};

// Remeshes the surface with edges of these lengths, which grow by a factor of 1.6 from ring to ring. Corners lie on the
// old surface, and edges sharper than kSharpAngle_deg stay (Botsch & Kobbelt, A remeshing approach to multiresolution
// modeling, 2004; CGAL's isotropic_remeshing). A scan's noise does not make triangles finer, because the surface's turn
// is measured at the size of the new triangles. The surface must be closed and consistent. Fails if CGAL fails.
Result<Remeshed> remesh(const TriangleMesh& surface, const EdgeLengths& lengths);

}  // namespace ringdown::mesh
