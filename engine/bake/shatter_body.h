// Breaks a baked body: cuts it into pieces, bakes each, and projects the body's motions on theirs. [worker]
#pragma once

#include "engine/bake/bake.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/modal/fracture/fracture.h"
#include "engine/shatter/pattern.h"

#include <cstdint>
#include <vector>

namespace ringdown::bake {

// The contents of [shatter] in an object file.
struct Shatter {
  std::vector<int> pieces = {30};  // for each level, coarsest first
  shatter::Pattern pattern = shatter::Pattern::kImpact;
  std::vector<Vec3> places_m;  // of blows; empty: one, the point of the surface that is nearest to the centre of mass
  std::uint64_t seed = 1;
  double min_mass_kg = 0;                         // lighter pieces join a neighbour; 0: 0.2 % of the body's mass
  double band_low_hz = 20, band_high_hz = 20000;  // of the pieces
};

// The pattern for each place and each level, and the stress of the body's modes on its skin; strength and the energy of
// cracks are those of the body's material and absent if that is ductile. Levels are nested: pieces break again into
// those of the next level that they consist of, and have the stress of their modes for that. `whole` was baked from a
// free body of one material with options.interior, and `options` are its options: the pieces have its element, its
// surface points' error, its solver and its air, and all modes in their own band. Progress stage: "pieces". Fails as
// bake() does, and when a body breaks into one piece only.
Result<modal::Fracture> shatter_body(const Baked& whole, const Shatter& shatter, const BakeOptions& options,
                                     const Progress& progress = {});

}  // namespace ringdown::bake
