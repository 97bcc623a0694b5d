// Noise of a scanner taken from a surface, its edges kept. [worker]
#pragma once

#include "engine/mesh/triangle_mesh.h"

namespace ringdown::mesh {

// Returns true where a surface cuts itself because of noise: nearly all of the triangles that cut each other are
// neighbours, most neighbours meet at more than some degrees, and triangles are small against the body.
bool is_folded_by_noise(const TriangleMesh& surface);

struct Denoised {
  TriangleMesh mesh;   // the same triangles with their nodes elsewhere; the volume stays
  double moved_m = 0;  // the root mean square of what nodes were moved
};

// Which normals are replaced by a plain mean before edges are looked for. kOfFolded, those far from the mean, keeps
// edges sharp; kOfAll makes them a triangle or two round, and unfolds more.
enum class FirstAverage { kOfFolded, kOfAll };

// Normals of triangles are averaged with those of their neighbours, the more the less they differ, and the nodes follow
// (Zheng, Fu, Au & Tai, Bilateral normal filtering for mesh denoising, IEEE TVCG 17, 2011). What is shorter than a few
// triangles goes; edges between large faces stay. Most triangles that noise has folded unfold. The surface must be
// consistent. O(T).
Denoised denoise(const TriangleMesh& surface, FirstAverage first);

}  // namespace ringdown::mesh
