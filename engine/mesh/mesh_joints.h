// Checks how the elements of a mesh meet, and removes parts that meet wrongly. [worker]
//
// In a sound mesh neighbours share a whole face with all its nodes, one on each side of it, and from any element around
// a node or an edge one comes to any other by stepping through faces there. Then each piece has six motions without
// energy and no more. Where parts of a body touch in a node or an edge only, the joint has no meaning: under a force at
// one point of an elastic body the displacement there grows without limit as elements get smaller, so the result would
// depend on the size of the elements.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <string>

namespace ringdown::mesh {

// Removes elements that have the same nodes as an earlier one. Returns how many. O(E log E).
int drop_duplicates(TetMesh& mesh);

// How many parts there are that share no node. O(E).
int count_pieces(const TetMesh& mesh);

// Fails with one sentence, which says where, when elements overlap at a face, have the corners of a face in common but
// not its other nodes, or touch in an edge or a node only. The elements must be positively oriented. O(E log E).
Result<void> check_joints(const TetMesh& mesh, const std::string& name);

struct Trimmed {
  int crumbs = 0;  // parts removed
  int hinges = 0;  // elements removed
};

// Leaves only parts whose elements are joined by faces, so that check_joints() finds nothing: where parts meet in an
// edge or a node only, the smaller of them there is taken away. Then parts of fewer than `least` elements, except the
// largest part of all. Unused nodes go. O(E log E) for each round; a few rounds.
Trimmed keep_sound_parts(TetMesh& mesh, int least);

}  // namespace ringdown::mesh
