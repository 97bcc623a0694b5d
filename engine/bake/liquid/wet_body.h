// Finds which part of a body is wet by a liquid in it or around it, and how that changes its modes. [worker]
//
//   Result<WetPlan> plan = plan_liquids(liquids, unit_mesh, surface, units);    // fails on a level that cannot be
//
// wet_solver.h replaces the dry modes, and levels.h finds those of other levels. docs/how/liquid.md has the equations.
#pragma once

#include "engine/bake/liquid/filling.h"
#include "engine/base/result.h"
#include "engine/fem/assembly.h"
#include "engine/liquid/air_surface.h"
#include "engine/liquid/wetted.h"
#include "engine/mesh/boundary.h"
#include "engine/modal/bank.h"
#include "engine/solve/eigensolver.h"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace ringdown::bake {

inline constexpr double kDryBand = 1.5;   // highest frequency of the dry modes over the band's top
inline constexpr double kLiquidBand = 4;  // highest frequency of the liquid's modes over the band's top
inline constexpr double kFewer = 4;       // nodes of the wall over those of the coarser one, which shows the error

// One body of liquid, free of units: lengths in the body's, densities over the material's, speeds over sqrt(E / rho).
struct WetPart {
  liquid::Wetted wetted;
  double density = 0, sound_speed = 0;
  int wall_nodes = 0;
  double drag_si = 0;  // sqrt(rho eta / 2) [kg m^-2 s^-1/2]: times sqrt(omega), the resistance of its boundary layer
};

// The liquid of one basin at another level.
struct WetLevel {
  double level = 0, volume = 0;
  WetPart part;  // of the lowest level, at which the basin is empty, nothing
};

struct WetPlan {
  liquid::Skin skin;
  std::vector<WetPart> parts;
  std::vector<WetLevel> levels;  // ascending; empty unless they were asked for
  liquid::AirSurface air;
  std::vector<modal::LiquidNote> notes;
};

// The scale by which lengths, speeds and densities lose their units.
struct WetUnits {
  double length_m = 1, speed_m_s = 1, density_kg_m3 = 1;
};

// Finds what is wet. Fails with one sentence when a level lies below a basin's bottom or above its rim, when there is
// no basin, or none at a place that was named.
Result<WetPlan> plan_liquids(const Liquids& liquids, const mesh::TetMesh& unit_mesh, const mesh::Boundary& surface,
                             const WetUnits& units);

// Adds a filling to a plan whose skin is set, with lengths in that skin's unit; fails as plan_liquids() does.
Result<void> plan_filling(const Filling& filling, const WetUnits& units, WetPlan& plan);

// Matrices of some levels, as modal::LiquidLevels has them, free of units. The columns are the rigid motions, all m wet
// modes, and R further motions.
struct WetLevels {
  Eigen::VectorXd level, volume;  // L
  Eigen::MatrixXd further;        // 3S x R, at the skin's nodes; 0 of the last ones, too weak to be heard
  Eigen::MatrixXd stiffness, mass;
  Eigen::MatrixXd following;
  std::vector<Eigen::MatrixXd> added, bond, liquid_mass;
  Eigen::MatrixXd drag;  // m x L, as WetEffects::drag
};

// Changes of each of m modes by the liquids.
struct WetEffects {
  Eigen::VectorXd strain, motion;  // m: shares of the energy of strain and of motion that are in the body
  Eigen::VectorXd drag;            // m: decay by boundary layers is drag sqrt(omega) / (rho L) [1/s]
  Eigen::VectorXd errors;          // m: relative errors of the frequencies by the elements on the wet wall
  liquid::AirSurface air;
  Eigen::MatrixXd free_flow;           // of all free surfaces' samples, N x m, towards the air
  mesh::Points free_at, free_normals;  // N x 3, in the body's frame, free of units
  Eigen::VectorXd free_areas;
  std::vector<modal::LiquidNote> notes;
  std::optional<WetLevels> levels;
};

struct WetBody {
  solve::Eigenmodes modes;  // rigid motions first, then the wet modes up to the top, on the nodes of the dry ones
  Eigen::MatrixXd mixing;   // dry modes x wet modes without the rigid ones: what each dry mode gives
  WetEffects effects;
};

}  // namespace ringdown::bake
