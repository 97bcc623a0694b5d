// Measures the gap between a body's surface and the skin of its mesh. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

namespace ringdown::mesh {

// Returns for each of face_points(mesh) the distance [m] along the outward normal to the surface: positive where the
// body reaches farther than its mesh, at most `reach_m` either way. If flat facets approximate a curved surface, the
// distance is that to the curved surface (smooth_facets.h). The surface must be turned outward. An unsound surface
// (`soup`) is taken to lie where its winding number is one half, also across holes; that takes about ten times as long.
// The result does not depend on the number of threads (0: one per processor).
Eigen::VectorXd surface_gaps(const TetMesh& mesh, const TriangleMesh& surface, double reach_m, bool soup,
                             int threads = 0);

}  // namespace ringdown::mesh
