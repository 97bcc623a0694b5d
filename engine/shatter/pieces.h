// The pieces of a cut body: which parts hang together, level by level. [worker]
//
//   auto levels = levels_of(*cut, body, seeds->group_of_cell);
//   PieceMesh shard = piece_mesh(*cut, body, elements_of(levels.back(), 7));
#pragma once

#include "engine/shatter/cut.h"
#include "engine/shatter/piece_mesh.h"

#include <cstdint>
#include <vector>

namespace ringdown::shatter {

struct Piece {
  double volume_m3 = 0;      // of the curved body; exact in the sum over a level, good to the curvature for each piece
  std::int32_t coarser = 0;  // the piece of the next coarser level that it belongs to; -1 in the coarsest
  double crack_area_m2 = 0;  // of the faces between those pieces of the next finer level that belong to it
};

struct Level {
  std::vector<Piece> pieces;
  std::vector<std::int32_t> piece_of_element;  // for each of CutBody::elements
  double crack_area_m2 = 0;                    // of the faces between pieces, each counted once, as flat triangles
};

inline constexpr double kMinVolumeShare = 0.002;  // of the body's volume, for a piece of its own

// Finds the pieces of every level; the result has as many levels as `group_of_cell` (Seeds), coarsest first. A piece is
// connected through faces of its elements. In the finest level it is a cell, or one of the separate parts of a cell, or
// one side of a narrow neck (parted_at_necks). In the others, pieces are the connected sets of finer pieces of one
// group, so levels are nested. Pieces below `min_volume_share`, 0 to 1, smallest first, join the neighbour with the
// largest common area, if possible one of their group in the next coarser level. The number of pieces may therefore
// differ from the number of seeds either way. Each row of `group_of_cell` must have a number for each cell. About
// O(E^1.5) in a piece of E elements, for the necks; 20 ms for 48 pieces of 18,000 elements.
std::vector<Level> levels_of(const CutBody& cut, const mesh::TetMesh& body,
                             const std::vector<std::vector<std::int32_t>>& group_of_cell,
                             double min_volume_share = kMinVolumeShare);

// Numbers of the elements of a piece, ascending; for piece_mesh(). O(E).
std::vector<std::int64_t> elements_of(const Level& level, std::int32_t piece);

}  // namespace ringdown::shatter
