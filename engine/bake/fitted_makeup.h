// A Makeup on one mesh, free of units (body_modes.h): what is assembled, and what modes lose by it. [worker]
//
//   Result<FittedMakeup> fitted = fit_makeup(makeup, material, unit_mesh, groups, units, pieces);
//   ...assemble fitted->solid, add fitted->holding...
//   fitted->shares(unit_mesh, shapes);             // kept with the modes
//   fitted->loss(shares, units, m, lambda, air);   // [1/s]
#pragma once

#include "engine/bake/body_heat.h"
#include "engine/bake/body_modes.h"
#include "engine/bake/makeup.h"
#include "engine/fem/holding.h"
#include "engine/fem/solid.h"
#include "engine/mesh/mesh_check.h"
#include "engine/modal/losses.h"

#include <cstdint>
#include <string>
#include <vector>

namespace ringdown::bake {

struct FittedMakeup {
  fem::Solid solid;
  fem::Solid lost;                         // its stiffness weighed with loss factors over the material's own
  std::vector<std::int32_t> part_of;       // E; empty: one part
  std::vector<modal::Material> materials;  // by part; the last is what belongs to no group
  BodyHeat heat;
  fem::Holding holding;
  std::vector<Support> springs;            // of the first layers of `holding`, in their order
  std::vector<double> point_damping_ns_m;  // of the points of `holding`
  int free_motions = 6;                    // rigid motions that cost no energy
  std::string key;                         // all that the modes depend on beside mesh and Poisson's ratio; empty: plain
  std::vector<std::string> notes;          // what holds where, for people

  // The shares of each mode's energy by which loss() tells its losses apart; empty for a plain body. `shapes` is 3N x
  // m.
  [[nodiscard]] ModeShares shares(const mesh::TetMesh& unit_mesh,
                                  const Eigen::Ref<const Eigen::MatrixXd>& shapes) const;

  // The decay rates [1/s] of mode `m`, whose eigenvalue is lambda [rad^2/s^2]; the air takes `air_per_s` of them.
  [[nodiscard]] modal::ModeLoss loss(const ModeShares& shares, const BodyUnits& units, Eigen::Index m, double lambda,
                                     double air_per_s) const;

  // Returns the largest eigenvalue whose damped frequency may lie below the top of the band.
  [[nodiscard]] double highest_lambda(double band_high_hz) const;
};

// Fails with a sentence when a group or a place is not there, a surface that slides is not flat, a material has no
// constants for its grain, or those are not a stable solid's.
Result<FittedMakeup> fit_makeup(const Makeup& makeup, const modal::Material& material, const mesh::TetMesh& unit_mesh,
                                const mesh::MeshGroups& groups, const BodyUnits& units, int pieces);

// An isotropic material whose waves are about as fast: for plans and guesses. The material itself without orthotropy.
modal::Material isotropic_stand_in(const modal::Material& material);

// The stiffness of a material of that grain at a point, in the axes of the mesh.
Result<fem::Matrix6> stiffness_at(const modal::Material& material, const Grain& grain, const Eigen::Vector3d& point_m);

}  // namespace ringdown::bake
