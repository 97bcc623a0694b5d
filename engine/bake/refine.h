// A recipe to a bank: meshed as fine as it asks or as it needs, and again until its error holds. [worker]
//
// Where a geometry names no mesh size, one is chosen (mesh_choice.h). With recipe.error > 0 the bake is repeated until
// the estimated error (fem/error_estimate.h) of every mode in the band is below it:
//
//   a geometry is meshed again with its sizes times (error / estimate)^(1/(2p)), in bounded steps, p the order; where
//   that would take too many unknowns, the order rises instead;
//   a mesh from a file keeps its nodes: the order rises up to 4, then each element is split into eight.
//
// It stops before a round of more than recipe.most_unknowns.
//
// With recipe.preview it is meshed coarsely instead, of order 2, so that it takes a second or less.
#pragma once

#include "engine/bake/object_file.h"

namespace ringdown::bake {

inline constexpr double kMaxChosenUnknowns = 150'000;  // that a chosen mesh size makes
inline constexpr int kMaxRounds = 6;

// Progress stages: "mesh" and those of bake(), from the second round on with the round and its error before them. Fails
// as meshing and bake() do, and when the error cannot be reached: the sentence names the one that was.
Result<BakedObject> bake_recipe(const ObjectRecipe& recipe, const modal::Material& material,
                                const Progress& progress = {});

}  // namespace ringdown::bake
