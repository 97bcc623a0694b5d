// Places seeds in a body's wall; their Voronoi cells become the pieces that the body breaks into. [worker]
//
//   Result<Seeds> seeds = make_seeds(body, {.pieces = {4, 14, 48}, .impact_m = {0.1, 0, 0}});
//
// Real fragments are far more uneven than the Voronoi cells of evenly spread seeds, so most patterns crowd seeds around
// the blow. The standard deviation of the areas of 60 cells on a square plate of 26 cm, over their mean, is 0.55
// (kUniform), 1.01 (kImpact) and 0.99 (kRadial). Seeds lie in the wall itself, so that the planes between them cut a
// thin wall at right angles.
#pragma once

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/mesh/tet_mesh.h"

#include <cstdint>
#include <vector>

namespace ringdown::shatter {

enum class Pattern {
  kUniform,  // every part of the wall is as likely
  kImpact,   // the density falls as (r0 / (r0 + r))^2 with the distance r from the impact; r0 = 0.054 diagonals of the
             // body's bounding box, 2 cm for a square plate of 26 cm
  kRadial,   // rays from the impact, and rings around it whose radii grow by 1.6; places beyond the wall are filled as
             // kImpact fills them
};

constexpr int kMaxPieces = 4096;

struct PatternOptions {
  Pattern pattern = Pattern::kImpact;
  std::vector<int> pieces = {48};  // number of seeds in each level, coarsest first, ascending, 1 to kMaxPieces
  Vec3 impact_m;                   // near the body: within one diagonal of its bounding box from the box's centre
  std::uint64_t seed = 1;
  double min_distance_m = 0;  // between seeds; 0: 1.5 wall thicknesses, the wall being 2 volume / surface
};

struct Seeds {
  mesh::Points points;  // n x 3 [m], inside the straight elements; n is the last of PatternOptions::pieces
  // Each level, coarsest first, has n numbers: the group that each fine cell belongs to. Groups are 0 ... pieces - 1
  // and none is empty; each group is a union of groups of the next level, and in the last level each cell is a group.
  std::vector<std::vector<std::int32_t>> group_of_cell;
};

// Places the seeds. The result depends on the arguments alone, not on the computer's random numbers. Only the elements'
// corners are used. If seeds cannot keep the least distance, the distance shrinks until they can. Fails if `pieces` is
// empty, not ascending or out of range, or if the impact is not finite or far from the body. Costs O(E) and some
// thousand distances for each seed: 10 ms for 48.
Result<Seeds> make_seeds(const mesh::TetMesh& body, const PatternOptions& options);

}  // namespace ringdown::shatter
