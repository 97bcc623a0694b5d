// Checks how the elements of a mesh meet, and removes parts that meet wrongly. [worker]
//
// In a sound mesh, neighbours share a whole face with all its nodes, one on each side, and all elements around a node
// or an edge are connected through faces there. Each piece then has exactly six motions without energy. If parts of a
// body touch in a node or an edge only, the joint has no meaning: under a force at one point of an elastic body the
// displacement there grows without limit as elements get smaller, so the result would depend on the size of the
// elements.
#pragma once

#include "engine/base/result.h"
#include "engine/mesh/tet_mesh.h"

#include <string>

namespace ringdown::mesh {

// Removes elements whose nodes equal an earlier element's. Returns the number of removed elements. O(E log E).
int drop_duplicates(TetMesh& mesh);

// Returns the number of parts that share no node. O(E).
int count_pieces(const TetMesh& mesh);

// Fails, with one sentence that says where, if elements overlap at a face, share the corners of a face but not its
// other nodes, or touch in an edge or a node only. The elements must be positively oriented. O(E log E).
Result<void> check_joints(const TetMesh& mesh, const std::string& name);

struct Trimmed {
  int crumbs = 0;  // number of small parts removed
  int hinges = 0;  // number of elements removed at joints in an edge or a node only
};

// Keeps only parts whose elements are joined by faces, so that check_joints() finds nothing. If parts meet in an edge
// or a node only, the smaller part there is removed. Parts of fewer than `min` elements are removed, except the
// largest part, and unused nodes are dropped. O(E log E) for each of a few rounds.
Trimmed keep_sound_parts(TetMesh& mesh, int min);

}  // namespace ringdown::mesh
