// Removes a scanner's noise from a surface and keeps its edges. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// Returns true if the surface cuts itself because of noise: nearly all triangles that cut each other are neighbours,
// most neighbours meet at more than a few degrees, and triangles are small beside the body.
bool is_folded_by_noise(const TriangleMesh& surface);

struct Denoised {
  TriangleMesh mesh;   // the original triangles with moved nodes; the volume is preserved
  double moved_m = 0;  // rms distance by which nodes were moved
};

// The normals that are replaced by a plain mean before edges are detected. kOfFolded replaces those far from the mean
// and keeps edges sharp; kOfAll rounds edges by a triangle or two, and unfolds more triangles.
enum class FirstAverage { kOfFolded, kOfAll };

// Averages each triangle's normal with its neighbours', with more weight the less they differ, and moves the nodes to
// match (Zheng, Fu, Au & Tai, Bilateral normal filtering for mesh denoising, IEEE TVCG 17, 2011). Features shorter than
// a few triangles vanish; edges between large faces stay. Most triangles that noise has folded unfold. The surface must
// be consistent. O(T).
Denoised denoise(const TriangleMesh& surface, FirstAverage first);

}  // namespace ringdown::mesh
