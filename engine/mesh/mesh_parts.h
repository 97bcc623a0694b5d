// Taking out of a mesh what does not hang together. [worker]
#pragma once

#include "engine/mesh/tet_mesh.h"

namespace ringdown::mesh {

struct Trimmed {
  int crumbs = 0;  // parts removed
  int hinges = 0;  // elements removed
};

// Leaves only parts whose elements are joined by faces, so that check_joints() finds nothing: where parts meet in an
// edge or a node only, the smaller of them there is taken away. Then parts of fewer than `least` elements, except the
// largest part of all. Unused nodes go. O(E log E) for each round; a few rounds.
Trimmed keep_sound_parts(TetMesh& mesh, int least);

}  // namespace ringdown::mesh
