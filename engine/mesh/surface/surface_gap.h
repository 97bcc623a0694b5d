// How far a body's surface lies from the skin of the mesh that was made of it. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"
#include "engine/mesh/triangle_mesh.h"

#include <Eigen/Core>

namespace ringdown::mesh {

// At each of face_points(mesh) the way [m] along the outward normal to the surface: above zero where the body reaches
// farther than its mesh, at most `reach_m` either way. Where flat facets stand for a curved surface, the way leads on
// to that (smooth_facets.h). The surface is turned outward. One that is not sound (`soup`) lies where its winding
// number is one half, also across its holes; that takes some ten times as long. The same bits for any number of threads
// (0: as many as there are processors).
Eigen::VectorXd surface_gaps(const TetMesh& mesh, const TriangleMesh& surface, double reach_m, bool soup,
                             int threads = 0);

}  // namespace ringdown::mesh
