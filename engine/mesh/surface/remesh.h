// Surfaces taken apart, closed, and in triangles of another size: what CGAL does on half-edges. [worker]
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/triangle_mesh.h"

#include <vector>

namespace ringdown::mesh {

// The same triangles where no edge has more than two of them and those around each point are connected: points are
// doubled where surfaces ran together, and borders that lie on each other are joined again in pairs. No triangle may
// name a node twice.
TriangleMesh separate(const TriangleMesh& mesh);

// Triangles that close a loop of points, as positions in it, turned like the loop. Empty when CGAL finds none. They are
// looked for among the triangles of the points' Delaunay tetrahedra, which takes about O(n log n) for n points; where
// that gives none, loops of up to kMaxExactHole points are searched among all triangles, O(n^3).
inline constexpr std::size_t kMaxExactHole = 500;
Triangles triangulate(const std::vector<Eigen::RowVector3d>& loop);

inline constexpr double kSharpAngle_deg = 40;  // between neighbours' normals: edges that remeshing keeps

struct Remeshed {
  TriangleMesh mesh;
  std::vector<double> deviations_m;  // of each triangle: the farthest of its middle and its sides' from the old surface
};

struct EdgeLengths {
  double longest_m = 0;    // where the surface is flat
  double shortest_m = 0;   // and shorter, down to this, where it bends
  double turn_deg = 45;    // the angle by which the surface may turn from one end of an edge to the other
  double leave_m = 0;      // how far triangles may leave a curved surface where the body is thin; 0: any way
  double leave_share = 0;  // and where it is thicker, as a share of its thickness there
};

// Triangles with edges of these lengths, which grow by a factor of 1.6 from ring to ring. Corners lie on the old
// surface, and edges sharper than kSharpAngle_deg stay (Botsch & Kobbelt, A remeshing approach to multiresolution
// modeling, 2004; CGAL's isotropic_remeshing). Noise of a scan makes nothing finer: what counts is how the surface
// turns at the size of the triangles that it gets. The surface must be closed and consistent. Fails when CGAL cannot.
Result<Remeshed> remesh(const TriangleMesh& surface, const EdgeLengths& lengths);

}  // namespace ringdown::mesh
