// The matrices of a body with its liquid at several levels, in one basis for all of them. [worker]
//
// The basis has the rigid motions, the wet modes as baked, and further motions: what the wet modes of some levels, and
// those of the empty body, have beside these. Their number is as small as kMissing allows. Compressible liquid is
// carried by motions that follow the body: y = Omega^-2 S^T V c in the eigenproblem of liquid/wet_modes.h, with the few
// columns of V for which that counts. Unlike the liquid's own modes, such motions change smoothly with the level.
#pragma once

#include "engine/bake/liquid/wet_solver.h"
#include "engine/modal/levels/liquid_levels.h"

#include <vector>

namespace ringdown::bake {

// `wet` was found by wet_body() from the other arguments; `mass` is that of the body, free of units. Fails when
// cancelled (stage "levels"), and for a body that its supports let move in some ways only.
Result<WetLevels> level_matrices(const WetPlan& plan, const mesh::Boundary& surface, const solve::Eigenmodes& dry,
                                 const fem::System& system, const std::vector<std::int32_t>& clamped, double top,
                                 const WetBody& wet, const modal::MassProperties& mass, const Progress& progress = {});

// One column of a bank's levels: the mode of WetLevels that is the bank's, with the sign that it has there.
struct LevelColumn {
  Eigen::Index mode = 0;
  double sign = 1;
};

// The units of WetLevels.
struct LevelUnits {
  double length_m = 1, lambda = 1, density_kg_m3 = 1;
};

// Returns the levels of a bank whose modes are `columns`; the modes that it lacks are further columns, before the
// further motions. `shapes` (3P x Q) are those of the first Q further columns in kg^-1/2.
modal::LiquidLevels bank_levels(const WetLevels& levels, const std::vector<LevelColumn>& columns,
                                const Eigen::MatrixXd& shapes, const LevelUnits& units);

// The modes that the bank lacks, ascending.
std::vector<Eigen::Index> missing_modes(const WetLevels& levels, const std::vector<LevelColumn>& columns);

}  // namespace ringdown::bake
